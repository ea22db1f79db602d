import { useState } from "react";

const SHOWN_MS = 1500;

/** Copies the address of what is shown now. */
export function CopyLink() {
  const [copied, setCopied] = useState(false);
  const copy = async () => {
    await navigator.clipboard.writeText(window.location.href);
    setCopied(true);
    setTimeout(() => setCopied(false), SHOWN_MS);
  };
  return (
    <button type="button" title="Copy a link that shows the same" onClick={() => void copy()}>
      {copied ? "Copied" : "Copy link"}
    </button>
  );
}
