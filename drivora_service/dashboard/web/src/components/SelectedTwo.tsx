/** What can be done with the selected rows: two of them are compared. */
export function SelectedTwo({
  number,
  what,
  onCompare,
  onClear,
}: {
  readonly number: number;
  /** What is selected, such as `runs`. */
  readonly what: string;
  readonly onCompare: () => void;
  readonly onClear: () => void;
}) {
  return (
    <>
      <button
        type="button"
        className="primary"
        disabled={number !== 2}
        title={number === 2 ? "Compare (c)" : `Two ${what} can be compared`}
        onClick={onCompare}
      >
        {number === 2 ? `Compare 2 ${what}` : `${number} selected: choose two to compare`}
      </button>
      <button type="button" onClick={onClear} aria-label={`Select no ${what}`}>
        ×
      </button>
    </>
  );
}
