import { useLive } from "./hub";

export function LiveState() {
  const live = useLive();
  return (
    <span
      className="live"
      data-state={live ? "live" : "waiting"}
      role="status"
      title={live ? "Changes are shown as they happen" : "No connection, trying again"}
    >
      {live ? "live" : "no connection"}
    </span>
  );
}
