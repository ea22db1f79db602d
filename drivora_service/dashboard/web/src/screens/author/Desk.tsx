import { useQuery } from "@tanstack/react-query";
import { useRef } from "react";
import { api, body, type Schemas } from "../../api/client";
import type { Definitions } from "../../components/fields/jsonSchema";
import { useKeys } from "../../shell/keys";
import type { AuthorMapHandle } from "./AuthorMap";
import { DeskHead } from "./DeskHead";
import { DeskMap } from "./DeskMap";
import { DeskSide } from "./DeskSide";
import { deskKeys } from "./deskKeys";
import { ProblemList } from "./ProblemList";
import { takesDetour } from "./shownActors";
import { TryRun } from "./TryRun";
import { type Desk as OnDesk, useDesk } from "./useDesk";
import type { Draft } from "./useDraft";
import { type KnownModels, useModels } from "./useModels";

/** The map, the fields and the text of one scenario, or a run of it. */
export function Desk({
  draft,
  geometry,
  definitions,
  networks,
}: {
  readonly draft: Draft;
  readonly geometry: Schemas["NetworkGeometry"];
  readonly definitions: Definitions;
  readonly networks: readonly string[];
}) {
  const models = useModels();
  const { name } = geometry;
  const network = useQuery({
    queryKey: ["network", name],
    queryFn: async () =>
      body(await api.GET("/api/v1/networks/{name}", { params: { path: { name } } })),
  });
  const map = useRef<AuthorMapHandle>(null);
  const desk = useDesk(draft, geometry, models, network.data?.net_offset, map);
  if (!desk.run.data)
    return <Writing desk={desk} map={map} {...{ definitions, models, networks }} />;
  return (
    <>
      <div className="head">
        <h1>Scenario on {name}</h1>
        <p className="answer">A run of {draft.origin ? draft.name : "what is written"}</p>
      </div>
      <TryRun
        id={desk.run.data.id}
        editedFrom={draft.origin?.run ?? ""}
        geometry={geometry}
        camera={desk.camera.current}
        onBack={() => desk.run.reset()}
      />
    </>
  );
}

function Writing({
  desk,
  map,
  definitions,
  models,
  networks,
}: {
  readonly desk: OnDesk;
  readonly map: React.RefObject<AuthorMapHandle | null>;
  readonly definitions: Definitions;
  readonly models: KnownModels;
  readonly networks: readonly string[];
}) {
  useKeys(deskKeys(desk, () => map.current));
  return (
    <>
      <DeskHead desk={desk} />
      <div className="author">
        <div className="author-main">
          <DeskMap desk={desk} map={map} />
          <ProblemList
            scenario={desk.draft.scenario}
            inspection={desk.inspection}
            unreadable={desk.unreadable}
            detours={desk.actors.filter(takesDetour)}
            onGo={desk.go}
          />
        </div>
        <DeskSide desk={desk} definitions={definitions} models={models} networks={networks} />
      </div>
    </>
  );
}
