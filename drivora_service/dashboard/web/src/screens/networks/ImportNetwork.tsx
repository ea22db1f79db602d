import { useEffect, useRef } from "react";
import { useScope } from "../../shell/session";
import { ImportForm } from "./ImportForm";
import { FORMATS } from "./networkFile";

const ACCEPTED = Object.values(FORMATS).flatMap(({ endings }) => endings);

/** Takes a file, by the button or dropped, and imports the network in it. */
export function ImportNetwork({
  file,
  busy,
  onFile,
  onBusy,
  onClose,
}: {
  readonly file: File | undefined;
  readonly busy: boolean;
  readonly onFile: (file: File | undefined) => void;
  /** Told whether a file is being sent, which another must not replace. */
  readonly onBusy: (busy: boolean) => void;
  readonly onClose: () => void;
}) {
  const { mayAdminister, scope } = useScope();
  const chooser = useRef<HTMLInputElement>(null);
  const frame = useRef<HTMLElement>(null);
  useEffect(() => (chooser.current ?? frame.current)?.focus(), []);
  return (
    <section
      ref={frame}
      className="panel import"
      aria-labelledby="import-title"
      tabIndex={-1}
      onKeyDown={(event) => {
        // A file that is being sent is cancelled by its button only.
        if (event.key === "Escape" && !busy) onClose();
      }}
    >
      <header>
        <h2 id="import-title">Import a network</h2>
        <button type="button" className="plain end" aria-label="Close" onClick={onClose}>
          ×
        </button>
      </header>
      <div className="inside">
        {mayAdminister ? (
          <>
            <label className="file" data-busy={busy}>
              <input
                ref={chooser}
                type="file"
                disabled={busy}
                className="hidden-visually"
                accept={ACCEPTED.join(",")}
                onChange={(event) => {
                  const chosen = event.target.files?.[0];
                  // The same file can be chosen again, which may have changed.
                  event.target.value = "";
                  if (chosen) onFile(chosen);
                }}
              />
              <span className="button">{file ? "Choose another file" : "Choose a file"}</span>
              <span className="quiet">
                or drop it here: <code>.net.xml</code> of SUMO, <code>.xodr</code> of OpenDRIVE,{" "}
                <code>.osm</code> of OpenStreetMap
              </span>
            </label>
            {file && (
              <ImportForm
                key={`${file.name} ${file.size} ${file.lastModified}`}
                file={file}
                onBusy={onBusy}
              />
            )}
          </>
        ) : (
          <p>
            Importing a network needs a token with the scope <code>admin</code>
            {scope && (
              <>
                ; you are signed in with the scope <code>{scope}</code>
              </>
            )}
            . The operator of the service makes tokens.
          </p>
        )}
      </div>
    </section>
  );
}
