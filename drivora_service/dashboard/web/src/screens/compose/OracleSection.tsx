import type { Schemas } from "../../api/client";
import { Problems } from "../../components/fields/Field";
import { plain } from "../failures/words";
import { countedOracles, violatedBeside, withCounted } from "./counting";
import type { Form } from "./form";
import { Folded, Section } from "./Section";

type Oracle = Schemas["Oracle"];

/** Which violations count as failures. */
export function OracleSection({ form }: { readonly form: Form }) {
  const { catalogues, draft } = form;
  const { oracles } = catalogues;
  const chosen = countedOracles(catalogues, draft);
  const violated = violatedBeside(catalogues, draft);
  const problems = form.problemsOf("/oracles", { inside: true });
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
      <p>
        {chosen.length === 0 ? "Nothing counts." : `A violation of ${listed(chosen.map(plain))}.`}{" "}
        {draft.settings.oracles !== undefined && (
          <button type="button" className="clear" onClick={() => form.set("/oracles", undefined)}>
            Back to the default
          </button>
        )}
      </p>
      <Violated
        counted={violated.filter((name) => chosen.includes(name))}
        left={violated.filter((name) => !chosen.includes(name))}
      />
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

/** What the runs of the scenarios violated, beside what counts by default. */
function Violated({
  counted,
  left,
}: {
  readonly counted: readonly string[];
  readonly left: readonly string[];
}) {
  return (
    <>
      {counted.length > 0 && (
        <p className="quiet">
          {sentence(listed(counted.map(plain), "and"))} {counted.length === 1 ? "counts" : "count"},
          too: the run of the scenario violated {counted.length === 1 ? "it" : "them"} at an ego's
          fault.
        </p>
      )}
      {left.length > 0 && (
        <p className="quiet">
          The run of the scenario violated {listed(left.map(plain), "and")} at an ego's fault, which
          {left.length === 1 ? " does" : " do"} not count.
        </p>
      )}
    </>
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

function listed(words: readonly string[], last = "or"): string {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} ${last} ${words.at(-1)}`;
}

function sentence(words: string): string {
  return `${words.charAt(0).toUpperCase()}${words.slice(1)}`;
}
