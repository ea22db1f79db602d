/// <reference lib="webworker" />
import { Connection } from "./connection";
import type { Said, Told } from "./messages";

/** One connection for all tabs: browsers open only six to a host. */
const tabs = new Set<MessagePort>();
const connection = new Connection((told) => {
  for (const tab of tabs) tab.postMessage(told);
});

(self as unknown as SharedWorkerGlobalScope).onconnect = (event) => {
  const port = event.ports[0];
  if (!port) return;
  tabs.add(port);
  port.onmessage = ({ data }: MessageEvent<Said>) => {
    if (data === "again") connection.again();
    else tabs.delete(port);
  };
  port.postMessage({ type: "state", live: connection.live } satisfies Told);
};
