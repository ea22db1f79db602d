import { useState } from "react";

/** A drawing that the service makes; where it cannot, the place says so. */
export function Picture({ src, alt }: { readonly src: string; readonly alt: string }) {
  const [failed, setFailed] = useState("");
  if (!src || failed === src)
    return <span className="picture none">{src ? "no picture" : "nothing was recorded"}</span>;
  return (
    <span className="picture">
      <img src={src} alt={alt} loading="lazy" onError={() => setFailed(src)} />
    </span>
  );
}
