import type { Schemas } from "../../api/client";
import { Problems } from "../../components/fields/Field";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { isSame } from "../../components/fields/typed";
import { plain } from "../failures/words";
import type { Form } from "./form";
import { Folded, Section } from "./Section";

type Oracle = Schemas["Oracle"];

/** Which violations count as failures. */
export function OracleSection({ form }: { readonly form: Form }) {
  const { oracles, definitions } = form.catalogues;
  const schema = propertiesOf(definitions.CampaignDocument, definitions).oracles;
  const standard = namesIn(schema?.default);
  const given = form.draft.settings.oracles;
  const chosen = given === undefined ? standard : namesIn(given);
  const problems = form.problemsOf("/oracles", { inside: true });
  const toggle = (name: string) => {
    const next = chosen.includes(name)
      ? chosen.filter((one) => one !== name)
      : inOrder([...chosen, name], oracles);
    const isStandard = isSame(next.toSorted(), standard.toSorted());
    form.set("/oracles", isStandard ? undefined : next);
  };
  const laws = oracles.filter(({ formula }) => formula !== "");
  const others = oracles.filter(({ formula }) => formula === "");
  return (
    <Section
      pointer="/oracles"
      title="What counts as a failure"
      says="all oracles judge every run"
      problems={[]}
    >
      <p>
        {chosen.length === 0 ? "Nothing counts." : `A violation of ${listed(chosen.map(plain))}.`}{" "}
        {given !== undefined && (
          <button type="button" className="clear" onClick={() => form.set("/oracles", undefined)}>
            Back to the default
          </button>
        )}
      </p>
      <Problems problems={problems} />
      <Folded title="Oracles" says={`${count(others, chosen)} of ${others.length} count`}>
        <Checks oracles={others} chosen={chosen} onToggle={toggle} />
      </Folded>
      {laws.length > 0 && (
        <Folded title="Traffic laws" says={`${count(laws, chosen)} of ${laws.length} count`}>
          <Checks oracles={laws} chosen={chosen} onToggle={toggle} />
        </Folded>
      )}
    </Section>
  );
}

function Checks({
  oracles,
  chosen,
  onToggle,
}: {
  readonly oracles: readonly Oracle[];
  readonly chosen: readonly string[];
  readonly onToggle: (name: string) => void;
}) {
  return (
    <div className="checks">
      {oracles.map(({ name, definition, installed, reason }) => (
        <label key={name} data-disabled={!installed}>
          <input
            type="checkbox"
            checked={chosen.includes(name)}
            disabled={!installed && !chosen.includes(name)}
            onChange={() => onToggle(name)}
          />
          <span>
            {plain(name)}
            <span className="quiet"> {installed ? definition : `not usable here: ${reason}`}</span>
          </span>
        </label>
      ))}
    </div>
  );
}

function namesIn(value: unknown): readonly string[] {
  return Array.isArray(value) ? value.map(String) : [];
}

/** Returns names in the order of the catalogue; others stand at the end. */
function inOrder(names: readonly string[], oracles: readonly Oracle[]): readonly string[] {
  const known = oracles.map(({ name }) => name);
  return [
    ...known.filter((name) => names.includes(name)),
    ...names.filter((name) => !known.includes(name)),
  ];
}

function count(oracles: readonly Oracle[], chosen: readonly string[]): number {
  return oracles.filter(({ name }) => chosen.includes(name)).length;
}

function listed(words: readonly string[]): string {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} or ${words.at(-1)}`;
}
