import { useState } from "react";
import type { FoundScenario } from "../compose/draft";
import { ExampleSource, RunSource } from "../compose/ScenarioSources";
import { useEarlier, wordsOf } from "./earlier";
import { FileChoice } from "./FileChoice";
import { emptyScenario } from "./scenario";
import type { Draft } from "./useDraft";

/** The first step of a scenario: its network, or a file. */
export function Begin({
  draft,
  networks,
  town,
}: {
  readonly draft: Draft;
  readonly networks: readonly string[];
  /** The network that the draft names, and that is not there; "" for none. */
  readonly town: string;
}) {
  const [refusal, setRefusal] = useState("");
  const earlier = useEarlier();
  const add = ({ document, label, run = "" }: FoundScenario) =>
    draft.open(document, { label, run });
  return (
    <>
      <div className="head">
        <h1>Author</h1>
        <p className="answer">Write a scenario on the map, and see at once how it is driven</p>
      </div>
      <section className="state author-begin">
        {town && (
          <p role="alert">
            The scenario takes place on <code>{town}</code>, which is not among the networks here.
            Import it, or choose another network.
          </p>
        )}
        <h2>On which network?</h2>
        <ul className="author-towns">
          {networks.map((name) => (
            <li key={name}>
              <button type="button" onClick={() => draft.open(emptyScenario(name))}>
                {name}
              </button>
            </li>
          ))}
        </ul>
        <h2>Or begin with a scenario</h2>
        <div className="sources">
          <FileChoice onOpen={draft.open} onRefused={setRefusal} />
          <RunSource onAdd={add} onRefused={setRefusal} />
          <ExampleSource onAdd={add} />
        </div>
        {earlier.length > 0 && (
          <>
            <h2>Or go on with one that you wrote before</h2>
            <ul className="author-towns">
              {earlier.map((one) => (
                <li key={one.at}>
                  <button
                    type="button"
                    onClick={() => draft.open(one.scenario, one.origin, one.isEdited)}
                  >
                    {wordsOf(one)}
                  </button>
                </li>
              ))}
            </ul>
          </>
        )}
        {refusal && (
          <p role="alert" className="problem">
            {refusal}
          </p>
        )}
      </section>
    </>
  );
}
