import { useEffect, useState } from "react";
import { addressOf } from "../../service";
import type { Run } from "./columns";

const WAIT_MS = 250;
const WIDTH_PX = 760;
const HEIGHT_PX = 220;

/** A row and where it is. */
export interface Pointed {
  readonly run: Run;
  readonly element: HTMLElement;
}

/** The picture of a run beside the row under the pointer or the keyboard. */
export function RunPreview({ pointed }: { readonly pointed: Pointed | undefined }) {
  const [shown, setShown] = useState<Pointed>();
  useEffect(() => {
    const timer = setTimeout(() => setShown(pointed), pointed ? WAIT_MS : 0);
    return () => clearTimeout(timer);
  }, [pointed]);
  // A run without a recording has no picture.
  if (!shown || shown !== pointed || !shown.run.trace_sha256) return null;
  // A list that was loaded anew has other rows.
  if (!shown.element.isConnected) return null;
  return <Picture key={shown.run.id} {...shown} />;
}

function Picture({ run, element }: Pointed) {
  const [state, setState] = useState<"loading" | "there" | "none">("loading");
  const row = element.getBoundingClientRect();
  const below = row.bottom + HEIGHT_PX < window.innerHeight;
  if (state === "none") return null;
  return (
    <div
      className="preview"
      data-state={state}
      style={{
        width: WIDTH_PX,
        // At the right: what tells the rows apart stays in sight.
        left: Math.max(row.right - WIDTH_PX - 8, 24),
        ...(below ? { top: row.bottom + 4 } : { bottom: window.innerHeight - row.top + 4 }),
      }}
    >
      <img
        src={addressOf(`/api/v1/runs/${encodeURIComponent(run.id)}/picture`)}
        alt={`The run ${run.id} from above`}
        onLoad={() => setState("there")}
        onError={() => setState("none")}
      />
    </div>
  );
}
