import type { Schemas } from "../../api/client";
import { fieldId, Problems } from "../../components/fields/Field";
import { valueAt } from "../../components/fields/pointers";
import { fixed } from "../../components/numbers";
import { type Editing, problemsOf } from "./editing";
import { type ListName, NOUNS } from "./scenario";

/** The model of an actor, chosen by its class. */
export function ModelChoice({
  editing,
  pointer,
  list,
  models,
}: {
  readonly editing: Editing;
  readonly pointer: string;
  readonly list: ListName;
  readonly models: readonly Schemas["Model"][];
}) {
  const kind = { npc_walkers: "walker", npc_obstacles: "obstacle" }[list as string] ?? "vehicle";
  const own = models.filter((model) => model.kind === kind);
  const classes = new Map<string, Schemas["Model"][]>();
  for (const model of own) {
    const name =
      model.vehicle_class ?? (model.name.startsWith("vehicle.") ? "parked wreck" : NOUNS[list]);
    classes.set(name, [...(classes.get(name) ?? []), model]);
  }
  const value = valueAt(editing.scenario, pointer);
  const problems = problemsOf(editing)(pointer);
  const chosen = own.find(({ name }) => name === value);
  return (
    <div className="field" data-kind="choice">
      <label htmlFor={fieldId(pointer)}>Model</label>
      <span className="control">
        <select
          id={fieldId(pointer)}
          value={String(value ?? "")}
          aria-invalid={problems.length > 0}
          onChange={({ target }) => editing.set(pointer, target.value)}
        >
          {/* Other spellings of a model, too, are what the document says. */}
          {!chosen && <option value={String(value ?? "")}>{String(value ?? "not given")}</option>}
          {[...classes].map(([name, items]) => (
            <optgroup key={name} label={name}>
              {items.map((model) => (
                <option key={model.name} value={model.name}>
                  {model.name.replace(/^(vehicle|walker|static\.prop)\./, "")}
                </option>
              ))}
            </optgroup>
          ))}
        </select>
      </span>
      <div className="about">
        {chosen && (
          <p className="quiet">
            {fixed(chosen.length, 2)} × {fixed(chosen.width, 2)} m
            {chosen.max_speed > 0 && `, up to ${fixed(chosen.max_speed, 0)} m/s`}
          </p>
        )}
        <Problems problems={problems} />
      </div>
    </div>
  );
}
