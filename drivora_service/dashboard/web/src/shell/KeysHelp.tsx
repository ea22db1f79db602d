import { useEffect, useRef } from "react";
import { keysNow } from "./keys";

export function KeysHelp({ onClose }: { readonly onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => dialog.current?.showModal(), []);
  const seen = new Set<string>();
  const rows = keysNow().filter(({ keys }) => !seen.has(keys) && seen.add(keys));
  return (
    <dialog ref={dialog} className="keys" onClose={onClose} aria-labelledby="keys-title">
      <h2 id="keys-title">Keys of this screen</h2>
      <dl>
        {rows.map(({ keys, does }) => (
          <div key={keys}>
            <dt>
              {keys.split(" ").map((key, place) => (
                // biome-ignore lint/suspicious/noArrayIndexKey: the keys of one row never move
                <kbd key={place}>{key}</kbd>
              ))}
            </dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
      <form method="dialog" style={{ marginTop: 16 }}>
        <button type="submit">Close</button>
      </form>
    </dialog>
  );
}
