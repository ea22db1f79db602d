/** What can be done with the selected runs: two of them are compared. */
export function SelectedRuns({
  number,
  onCompare,
  onClear,
}: {
  readonly number: number;
  readonly onCompare: () => void;
  readonly onClear: () => void;
}) {
  return (
    <>
      <button
        type="button"
        className="primary"
        disabled={number !== 2}
        title={number === 2 ? "Compare (c)" : "Two runs can be compared"}
        onClick={onCompare}
      >
        {number === 2 ? "Compare 2 runs" : `${number} selected: choose two to compare`}
      </button>
      <button type="button" onClick={onClear} aria-label="Select no run">
        ×
      </button>
    </>
  );
}
