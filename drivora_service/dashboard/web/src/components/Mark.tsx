/** How a state is shown: a sign and a word, so that colour is never needed to tell. */
export type Tone = "good" | "bad" | "lost" | "quiet" | "live";

export interface MarkLook {
  readonly sign: string;
  readonly tone: Tone;
  readonly text: string;
}

export function Mark({ sign, tone, text }: MarkLook) {
  return (
    <span className="mark" data-sign={sign} data-tone={tone}>
      {text}
    </span>
  );
}
