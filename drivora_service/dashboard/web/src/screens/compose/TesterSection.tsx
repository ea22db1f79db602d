import { useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { fieldId, Problems } from "../../components/fields/Field";
import { type Json, valueAt } from "../../components/fields/pointers";
import { Mark } from "../../components/Mark";
import { Prose } from "../../components/Prose";
import { withRow } from "./draft";
import type { Form } from "./form";
import { PartRow } from "./PartRow";
import { Section } from "./Section";
import { TesterSettings } from "./TesterParts";

type Tester = Schemas["Tester"];

/** The method of a campaign. */
export function TesterSection({ form }: { readonly form: Form }) {
  const now = valueAt(form.draft.settings, "/tester");
  const chosen = valueAt(now, "/name");
  // Arrow keys pass over other methods: each keeps what was set for it.
  const before = useRef(new Map<string, Json>());
  const choose = (name: string) => {
    if (typeof chosen === "string" && now !== undefined) before.current.set(chosen, now);
    form.set("/tester", before.current.get(name) ?? { name });
  };
  return (
    <Section
      pointer="/tester"
      title="Method"
      says="chooses what is simulated next"
      problems={form.problemsOf("/tester")}
    >
      <fieldset className="radios" id={fieldId("/tester/name")} tabIndex={-1}>
        <legend className="hidden-visually">Method</legend>
        <Problems problems={form.problemsOf("/tester/name")} />
        {form.catalogues.testers.map((tester) => (
          <label key={tester.name} title={tester.source} data-disabled={!tester.installed}>
            <input
              type="radio"
              name="tester"
              value={tester.name}
              checked={tester.name === chosen}
              disabled={!tester.installed}
              onChange={() => choose(tester.name)}
            />
            <Described tester={tester} />
          </label>
        ))}
      </fieldset>
      <OwnSpace form={form} />
      <TesterSettings form={form} pointer="/tester" />
    </Section>
  );
}

/** The space that the authors of the chosen method search, unless it is chosen. */
function OwnSpace({ form }: { readonly form: Form }) {
  const { settings } = form.draft;
  const tester = valueAt(settings, "/tester/name");
  const own = form.catalogues.presets.find(({ name }) => name === tester);
  if (!own || valueAt(settings, "/space/preset") === own.name) return null;
  return (
    <p>
      The authors of this method search the space <code>{own.name}</code>: {own.description}.{" "}
      <button type="button" onClick={() => form.set("/space", { preset: own.name })}>
        Vary that
      </button>
    </p>
  );
}

function Described({ tester }: { readonly tester: Tester }) {
  return (
    <span>
      <strong>{tester.title}</strong>{" "}
      <span className="quiet">
        <Prose text={tester.description} />
      </span>
      {!tester.installed && (
        <>
          {" "}
          <Mark sign="⊘" tone="lost" text="not usable here:" /> <Prose text={tester.reason} />
        </>
      )}
    </span>
  );
}

/** The methods of a study. */
export function MethodsSection({ form }: { readonly form: Form }) {
  const { testers } = form.catalogues;
  const [added, setAdded] = useState("");
  const now = valueAt(form.draft.settings, "/methods");
  const rows: readonly Json[] = Array.isArray(now) ? now : [];
  return (
    <Section
      pointer="/methods"
      title="Methods"
      says="each searches with each ADS"
      problems={form.problemsOf("/methods")}
    >
      <ol className="parts">
        {rows.map((row, place) => {
          const pointer = `/methods/${place}`;
          const name = String(valueAt(row, "/name"));
          const tester = testers.find((one) => one.name === name);
          const isShuffled = valueAt(row, "/feedback") === "shuffled";
          return (
            <PartRow
              // biome-ignore lint/suspicious/noArrayIndexKey: a row is known by its place alone
              key={place}
              form={form}
              pointer={pointer}
              schema="StudyMethodDocument"
              title={tester?.title ?? name}
              description={tester?.description ?? ""}
              standard={isShuffled ? `${name} without feedback` : name}
            >
              <TesterSettings form={form} pointer={pointer} />
            </PartRow>
          );
        })}
      </ol>
      <div className="doing">
        <select
          aria-label="Another method"
          value={added}
          onChange={({ target }) => setAdded(target.value)}
        >
          <option value="">choose a method</option>
          {testers.map(({ name, title, installed, reason }) => (
            <option key={name} value={name} disabled={!installed} title={reason}>
              {title}
            </option>
          ))}
        </select>
        <button
          type="button"
          disabled={!added}
          onClick={() => {
            form.set("/methods", withRow(rows, added));
            setAdded("");
          }}
        >
          Add the method
        </button>
      </div>
      <NotUsable testers={testers} />
    </Section>
  );
}

function NotUsable({ testers }: { readonly testers: readonly Tester[] }) {
  return testers
    .filter(({ installed }) => !installed)
    .map(({ name, title, reason }) => (
      <p key={name}>
        <Mark sign="⊘" tone="lost" text={`${title} is not usable here:`} /> <Prose text={reason} />
      </p>
    ));
}
