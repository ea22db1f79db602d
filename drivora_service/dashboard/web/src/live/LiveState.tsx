import { useLive } from "./hub";

export function LiveState() {
  const live = useLive();
  return (
    <span className="live" data-state={live ? "live" : "waiting"} role="status">
      {live ? "live" : "no connection, trying again"}
    </span>
  );
}
