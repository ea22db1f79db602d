import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { count } from "../../components/numbers";
import { Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { QueueTable } from "./QueueTable";
import { SlotTable } from "./SlotTable";
import { standing } from "./workers";

/** What each worker does, what waits, and what holds it up. */
export function WorkersScreen() {
  useTitle("Workers");
  const query = useQuery({
    queryKey: ["workers", "list"],
    queryFn: async () => body(await api.GET("/api/v1/workers")),
  });
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const workers = query.data;
  return (
    <>
      <div className="head">
        <h1>Workers</h1>
        <p className="answer" role="status">
          {standing(workers)}
        </p>
        <div className="actions">
          <Link to="/runs" search={{ status: ["queued", "running"] }} className="button">
            Runs that wait or run
          </Link>
        </div>
      </div>
      {workers.faults.map(({ name, detail }) => (
        <section key={name} className="panel fault" role="alert">
          <div className="inside">
            <h2>Nothing is run: {name.replaceAll("_", " ")}</h2>
            <p>{detail}</p>
          </div>
        </section>
      ))}
      <div className="columns-2-1">
        <section className="panel">
          <header>
            <h2>Queue by priority</h2>
          </header>
          <QueueTable queue={workers.queue} />
        </section>
        <section className="panel">
          <header>
            <h2>Runs that ended</h2>
          </header>
          <dl className="agent-facts inside">
            <dt>In the last minute</dt>
            <dd>{count(workers.ended_last_minute)}</dd>
            <dt>In the last hour</dt>
            <dd>{count(workers.ended_last_hour)}</dd>
          </dl>
        </section>
      </div>
      <section className="panel wide-table">
        <header>
          <h2>Slots</h2>
          <span className="quiet">Each has one worker process at a time</span>
        </header>
        {workers.slots.length > 0 ? (
          <SlotTable slots={workers.slots} />
        ) : (
          <p className="quiet note">No process with workers uses this data folder.</p>
        )}
      </section>
    </>
  );
}
