import { type DragEvent, useState } from "react";
import { fieldId, Problems } from "../../components/fields/Field";
import { readDocument } from "../../documents/files";
import { countingAsDefined } from "./counting";
import { type FoundScenario, type SeedScenario, scenarioPointer, withScenario } from "./draft";
import type { Form } from "./form";
import { ScenarioSources } from "./ScenarioSources";
import { Section } from "./Section";
import { partsOf } from "./scenarioWords";

/** The scenarios from which is searched: files, runs and examples. */
export function ScenarioSection({
  form,
  refusal,
}: {
  readonly form: Form;
  /** Why a scenario that the address names is not there. */
  readonly refusal?: string | undefined;
}) {
  const { kind, draft, change, problemsOf } = form;
  const { scenarios } = draft;
  const [refusals, setRefusals] = useState<readonly string[]>(refusal ? [refusal] : []);
  const [isOver, setOver] = useState(false);
  const add = (added: readonly FoundScenario[]) => {
    setRefusals([]);
    change((now) => {
      const next = { ...now, scenarios: added.reduce(withScenario, now.scenarios) };
      return countingAsDefined(next);
    });
  };
  const addFiles = async (files: readonly File[]) => {
    const read = await Promise.allSettled(
      files.map(async (file) => readDocument(file.name, await file.text())),
    );
    add(
      read.flatMap((one) =>
        one.status === "fulfilled"
          ? [{ label: one.value.name, origin: "of a file", document: one.value.document }]
          : [],
      ),
    );
    setRefusals(
      read.flatMap((one) => (one.status === "rejected" ? [String(one.reason.message)] : [])),
    );
  };
  const drop = {
    onDragOver: (event: DragEvent) => {
      event.preventDefault();
      setOver(true);
    },
    onDragLeave: () => setOver(false),
    onDrop: (event: DragEvent) => {
      event.preventDefault();
      setOver(false);
      void addFiles([...event.dataTransfer.files]);
    },
  };
  return (
    <Section
      pointer={kind === "study" || scenarios.length > 1 ? "/scenarios" : "/scenarios/none"}
      title={kind === "study" ? "Scenarios" : "Scenario"}
      says={saysOf(form)}
      problems={problemsOf("/scenarios")}
    >
      <div {...drop} className="seeds" data-over={isOver}>
        {scenarios.length > 0 && (
          <ul className="parts">
            {scenarios.map((scenario, place) => (
              <Seed
                key={scenario.id}
                form={form}
                scenario={scenario}
                pointer={scenarioPointer(kind, scenarios.length, place)}
              />
            ))}
          </ul>
        )}
        {refusals.map((text) => (
          <p key={text} role="alert" className="problem">
            {text}
          </p>
        ))}
        <ScenarioSources
          isFirst={scenarios.length === 0}
          onFiles={(files) => void addFiles(files)}
          onAdd={(one) => add([one])}
          onRefused={(text) => setRefusals([text])}
        />
      </div>
    </Section>
  );
}

function saysOf({ kind, draft }: Form): string {
  if (kind === "study") return "each is searched by itself";
  return draft.scenarios.length > 1 ? "they take turns" : "where the search begins";
}

function Seed({
  form,
  scenario,
  pointer,
}: {
  readonly form: Form;
  readonly scenario: SeedScenario;
  readonly pointer: string;
}) {
  const { id, label, origin, document, space } = scenario;
  const edit = (part: Partial<SeedScenario> | undefined) =>
    form.change((now) => ({
      ...now,
      scenarios: now.scenarios.flatMap((one) =>
        one.id !== id ? [one] : part ? [{ ...one, ...part }] : [],
      ),
    }));
  return (
    <li id={fieldId(pointer)} tabIndex={-1}>
      <div className="head">
        <input
          id={fieldId(`${pointer}/label`)}
          aria-label="Name of the scenario"
          value={label}
          maxLength={100}
          onChange={({ target }) => edit({ label: target.value })}
        />
        <span className="quiet">
          {partsOf(document).join(" · ")} <span title={origin}>· {origin}</span>
        </span>
        <button type="button" aria-label={`Remove ${label}`} onClick={() => edit(undefined)}>
          Remove
        </button>
      </div>
      {space && (
        <p>
          It has a space of its own.{" "}
          <button type="button" onClick={() => edit({ space: undefined })}>
            Use that of the study
          </button>
        </p>
      )}
      <Problems problems={form.problemsOf(pointer, { inside: true })} />
    </li>
  );
}
