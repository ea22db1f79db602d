import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { useRef, useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { count, fixed } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { useKeys } from "../../shell/keys";
import { useTitle } from "../../shell/useTitle";
import { ImportNetwork } from "./ImportNetwork";
import { useFileDrop } from "./useFileDrop";
import "./import.css";

type Network = Schemas["Network"];

const COLUMNS: readonly Column<Network>[] = [
  {
    id: "name",
    title: "Network",
    width: "minmax(180px, 1fr)",
    cell: ({ name }) => (
      <Link to="/networks/$name" params={{ name }} search={{}}>
        {name}
      </Link>
    ),
  },
  {
    id: "drivable",
    title: "Roads (lane km)",
    hint: "Length of all lanes that are open to cars, junctions left out",
    width: "130px",
    numeric: true,
    cell: (network) => fixed(network.drivable_km, 2),
  },
  { id: "lanes", title: "Lanes", width: "90px", numeric: true, cell: ({ lanes }) => count(lanes) },
  {
    id: "lights",
    title: "Traffic lights",
    width: "110px",
    numeric: true,
    cell: (network) => count(network.traffic_lights),
  },
  {
    id: "sidewalks",
    title: "Pavements",
    width: "100px",
    cell: (network) => (network.has_sidewalks ? "yes" : "no"),
  },
  {
    id: "extent",
    title: "Extent (m)",
    width: "130px",
    numeric: true,
    cell: ({ bounds: [west, south, east, north] }) =>
      `${Math.round((east ?? 0) - (west ?? 0))} × ${Math.round((north ?? 0) - (south ?? 0))}`,
  },
];

async function allNetworks(): Promise<readonly Network[]> {
  const { items } = body(await api.GET("/api/v1/networks"));
  return Promise.all(
    items.map(async ({ name }) =>
      body(await api.GET("/api/v1/networks/{name}", { params: { path: { name } } })),
    ),
  );
}

export function Networks() {
  useTitle("Networks");
  const navigate = useNavigate();
  const query = useQuery({ queryKey: ["network", "list"], queryFn: allNetworks });
  const [importing, setImporting] = useState(false);
  const [file, setFile] = useState<File>();
  const [busy, setBusy] = useState(false);
  const opener = useRef<HTMLButtonElement>(null);
  const held = useFileDrop((dropped) => {
    if (busy) return;
    setFile(dropped);
    setImporting(true);
  });
  useKeys([{ keys: "i", does: "import a network", run: () => setImporting(true) }]);
  const close = () => {
    setImporting(false);
    setFile(undefined);
    opener.current?.focus();
  };
  return (
    <>
      <div className="head">
        <h1>Networks</h1>
        <p className="answer">
          {query.data && `${query.data.length} road networks that scenarios may take place on`}
        </p>
        <div className="actions">
          <button
            ref={opener}
            type="button"
            aria-expanded={importing}
            onClick={() => (importing ? close() : setImporting(true))}
          >
            Import a network
          </button>
        </div>
      </div>
      {importing && (
        <ImportNetwork file={file} busy={busy} onFile={setFile} onBusy={setBusy} onClose={close} />
      )}
      {held && !busy && <div className="drop-here">Drop a network's file to import it</div>}
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : query.data.length === 0 ? (
        <Empty title="No network" command="drivora networks import FILE.net.xml" />
      ) : (
        <DataTable
          label="Networks"
          columns={COLUMNS}
          rows={query.data}
          idOf={({ name }) => name}
          onOpen={({ name }) =>
            void navigate({ to: "/networks/$name", params: { name }, search: {} })
          }
        />
      )}
    </>
  );
}
