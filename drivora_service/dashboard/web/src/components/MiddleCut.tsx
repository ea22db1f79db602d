const END = 10;

/** A text that is cut before its end where space is short: numbers at the end tell rows apart. */
export function MiddleCut({ text }: { readonly text: string }) {
  if (text.length <= 2 * END) return <>{text}</>;
  return (
    <span className="middle-cut" title={text}>
      <span>{text.slice(0, -END)}</span>
      <span>{text.slice(-END)}</span>
    </span>
  );
}
