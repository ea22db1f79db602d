import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import type { Definitions } from "../../components/fields/jsonSchema";
import { ActorProperties } from "./ActorProperties";
import type { Editing } from "./editing";
import { PlaceSearch } from "./PlaceSearch";
import { ScenarioProperties } from "./ScenarioProperties";
import { TextPanel } from "./TextPanel";
import type { Desk } from "./useDesk";
import type { KnownModels } from "./useModels";

/** The fields of what is chosen, or the text of the whole. */
export function DeskSide({
  desk,
  definitions,
  models,
  networks,
}: {
  readonly desk: Desk;
  readonly definitions: Definitions;
  readonly models: KnownModels;
  readonly networks: readonly string[];
}) {
  const agents = useQuery({
    queryKey: ["agents"],
    queryFn: async () => body(await api.GET("/api/v1/agents")),
  });
  const { draft, geometry, side, chosen } = desk;
  const problems = desk.inspection?.problems ?? [];
  const editing: Editing = { scenario: draft.scenario, problems, set: draft.set };
  return (
    <div className="author-side">
      <nav className="author-sides" aria-label="Fields or text">
        <button
          type="button"
          aria-pressed={side === "fields"}
          onClick={() => desk.setSide("fields")}
        >
          Fields
        </button>
        <button type="button" aria-pressed={side === "text"} onClick={() => desk.setSide("text")}>
          Text
        </button>
      </nav>
      {side === "text" ? (
        <TextPanel
          scenario={draft.scenario}
          problems={problems}
          asked={desk.asked?.pointer ?? (chosen.place || chosen.actor)}
          onRead={(document) => draft.change(document, "text")}
          onUnreadable={desk.setUnreadable}
        />
      ) : (
        <>
          <PlaceSearch
            geometry={geometry}
            ways={desk.actors.filter(({ list }) => list === "ego_vehicles").map(({ path }) => path)}
            onPart={desk.toPart}
            onPlace={desk.toPlace}
            onDrive={desk.drive}
            onWalk={desk.walk}
          />
          {chosen.actor ? (
            <ActorProperties
              editing={editing}
              pointer={chosen.actor}
              place={chosen.place}
              shown={desk.actors.find(({ pointer }) => pointer === chosen.actor)}
              definitions={definitions}
              models={models.list}
              agents={agents.data?.items ?? []}
              onPlace={desk.select}
              onRemove={desk.remove}
              onCopy={desk.copy}
              onExtend={desk.extend}
              onClose={desk.leave}
            />
          ) : (
            <ScenarioProperties
              editing={editing}
              definitions={definitions}
              networks={networks}
              lights={geometry.traffic_lights.map(({ id }) => id)}
            />
          )}
        </>
      )}
    </div>
  );
}
