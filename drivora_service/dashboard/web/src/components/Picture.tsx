import { useState } from "react";

/** A drawing that the service makes; where it cannot, the place says so. */
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
      <img src={src} alt={alt} loading="lazy" onError={() => setFailed(src)} />
    </span>
  );
}
