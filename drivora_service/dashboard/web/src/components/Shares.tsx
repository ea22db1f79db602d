import type { Tone } from "./Mark";
import { count } from "./numbers";

export interface Share {
  readonly words: string;
  readonly number: number;
  readonly tone: Tone;
}

/** How a whole is divided, as a bar; the numbers are in its words as well. */
export function Shares({ shares, of }: { readonly shares: readonly Share[]; readonly of: number }) {
  const said = shares
    .filter(({ number }) => number > 0)
    .map(({ number, words }) => `${count(number)} ${words}`)
    .join(", ");
  return (
    <span className="shares" role="img" aria-label={said} title={said}>
      {shares.map(({ words, number, tone }) => (
        <span
          key={words}
          data-tone={tone}
          style={{ width: `${of > 0 ? (number / of) * 100 : 0}%` }}
        />
      ))}
    </span>
  );
}
