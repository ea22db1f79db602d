import type { Schemas } from "../../api/client";
import { COUNTED_WORDS, countedOf } from "../../components/definition";
import { Problems } from "../../components/fields/Field";
import { plain } from "../failures/words";
import { countedOracles, withCounted } from "./counting";
import type { Form } from "./form";
import { Folded, Section } from "./Section";

type Oracle = Schemas["Oracle"];

/** Which violations count as failures. */
export function OracleSection({ form }: { readonly form: Form }) {
  const { catalogues, draft } = form;
  const { oracles } = catalogues;
  const chosen = countedOracles(catalogues, draft);
  const problems = [
    ...form.problemsOf("/counts"),
    ...form.problemsOf("/oracles", { inside: true }),
  ];
  const counts = countedOf(String(draft.settings.counts ?? "")) ?? "accountable";
  const toggle = (name: string) => {
    const next = chosen.includes(name) ? chosen.filter((one) => one !== name) : [...chosen, name];
    form.change((now) => withCounted(catalogues, now, next));
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
      <label className="one">
        Violations
        <select
          value={counts}
          onChange={({ target }) =>
            form.set("/counts", target.value === "accountable" ? undefined : target.value)
          }
        >
          {Object.entries(COUNTED_WORDS).map(([value, words]) => (
            <option key={value} value={value}>
              {words}
            </option>
          ))}
        </select>
      </label>
      <p>
        {chosen.length === 0
          ? "Nothing counts."
          : draft.settings.oracles === undefined
            ? "Of all oracles but observations."
            : `Of ${listed(chosen.map(plain))}.`}{" "}
        {draft.settings.oracles !== undefined && (
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

function count(oracles: readonly Oracle[], chosen: readonly string[]): number {
  return oracles.filter(({ name }) => chosen.includes(name)).length;
}

function listed(words: readonly string[]): string {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} or ${words.at(-1)}`;
}
