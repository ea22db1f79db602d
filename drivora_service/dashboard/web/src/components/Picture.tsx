import { useState } from "react";

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
        src={`${src}?moments=${MOMENTS}`}
        alt={alt}
        loading="lazy"
        onError={() => setFailed(src)}
      />
    </span>
  );
}

/** As many as are told apart in a card; the stylesheet has the size of a drawing of so many. */
const MOMENTS = 4;
