import { count } from "./numbers";

/** How much of a budget is spent, as a bar and in numbers. */
export function Progress({ done, of }: { readonly done: number; readonly of: number }) {
  const share = of > 0 ? Math.min(done / of, 1) : 0;
  return (
    <span className="progress" title={`${count(done)} of ${count(of)} simulations`}>
      <span className="rail" aria-hidden="true">
        <span style={{ width: `${share * 100}%` }} />
      </span>
      {count(done)} / {count(of)}
    </span>
  );
}
