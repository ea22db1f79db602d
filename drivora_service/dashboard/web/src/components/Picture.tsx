import { useState } from "react";
import type { Schemas } from "../api/client";

/**
 * The moments of a run that the service draws, without the title and the captions of the drawing:
 * at the size of a card they could not be read. Where there is no drawing, the place says so.
 */
export function Picture({
  src,
  alt,
  none = "nothing was recorded",
}: {
  readonly src: string;
  readonly alt: string;
  /** Why there is none. */
  readonly none?: string;
}) {
  const [failed, setFailed] = useState("");
  if (!src || failed === src)
    return <span className="picture none">{src ? "no picture" : none}</span>;
  return (
    <span className="picture">
      <img
        src={`${src}${src.includes("?") ? "&" : "?"}moments=${MOMENTS}`}
        alt={alt}
        loading="lazy"
        onError={() => setFailed(src)}
      />
    </span>
  );
}

/** As many as are told apart in a card; the stylesheet has the size of a drawing of so many. */
const MOMENTS = 4;

/** Returns the query of a picture whose moments lead to a violation, not to the gravest of its run. */
export function violationQuery({
  oracle,
  ego,
  step,
}: Pick<Schemas["Verdict"], "oracle" | "ego" | "step">): string {
  const query = new URLSearchParams({ oracle, ego });
  if (typeof step === "number") query.set("step", String(step));
  return `?${query}`;
}
