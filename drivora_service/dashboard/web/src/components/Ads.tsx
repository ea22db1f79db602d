import { adsHint, type Configured } from "./configuration";

/** An ADS with the parameters that differ from its defaults; its id is the hint. */
export function Ads({ of, label }: { readonly of: Configured; readonly label?: string }) {
  return <span title={adsHint(of)}>{label || of.configuration}</span>;
}
