import { useState } from "react";
import { Problems } from "../../components/fields/Field";
import { type Json, valueAt } from "../../components/fields/pointers";
import { Prose } from "../../components/Prose";
import { AgentSelect, AgentSettings, agentFieldId, NotInstalled } from "./AgentParts";
import { withRow } from "./draft";
import type { Form } from "./form";
import { PartRow } from "./PartRow";
import { Section } from "./Section";
import { agentsOf } from "./scenarioWords";

/** The ADS of a campaign. */
export function AgentSection({ form }: { readonly form: Form }) {
  const { agents } = form.catalogues;
  const name = valueAt(form.draft.settings, "/agent/name");
  const agent = agents.find((one) => one.name === name);
  const problems = form.problemsOf("/agent/name");
  return (
    <Section
      pointer="/agent"
      title="ADS"
      says="drives every ego"
      problems={form.problemsOf("/agent")}
    >
      <div>
        <AgentSelect
          id={agentFieldId("/agent")}
          label="ADS"
          agents={agents}
          value={typeof name === "string" ? name : ""}
          none={asInScenario(form)}
          isInvalid={problems.length > 0}
          onChange={(chosen) => form.set("/agent", chosen ? { name: chosen } : undefined)}
        />
        <Problems problems={problems} />
      </div>
      {agent && (
        <p className="quiet">
          <Prose text={agent.description} />
        </p>
      )}
      <AgentSettings form={form} pointer="/agent" />
      <NotInstalled agents={agents} />
    </Section>
  );
}

function asInScenario({ draft }: Form): string {
  const names = new Set(draft.scenarios.map(({ document }) => agentsOf(document)));
  const all = [...names].filter(Boolean).join("; ");
  return all ? `as in the scenario: ${all}` : "as in the scenario";
}

/** The ADSs of a study. */
export function AgentsSection({ form }: { readonly form: Form }) {
  const { agents } = form.catalogues;
  const [added, setAdded] = useState("");
  const now = valueAt(form.draft.settings, "/agents");
  const rows: readonly Json[] = Array.isArray(now) ? now : [];
  return (
    <Section
      pointer="/agents"
      title="ADSs"
      says="each drives every ego"
      problems={form.problemsOf("/agents")}
    >
      {rows.length === 0 && <p>As in the scenarios.</p>}
      <ol className="parts">
        {rows.map((row, place) => {
          const pointer = `/agents/${place}`;
          const name = String(valueAt(row, "/name"));
          return (
            <PartRow
              // biome-ignore lint/suspicious/noArrayIndexKey: a row is known by its place alone
              key={place}
              form={form}
              pointer={pointer}
              schema="StudyAgentDocument"
              title={name}
              description={agents.find((one) => one.name === name)?.description ?? ""}
              standard={name}
            >
              <AgentSettings form={form} pointer={pointer} />
            </PartRow>
          );
        })}
      </ol>
      <div className="doing">
        <AgentSelect
          label="Another ADS"
          agents={agents}
          value={added}
          none="choose an ADS"
          onChange={setAdded}
        />
        <button
          type="button"
          disabled={!added}
          onClick={() => {
            form.set("/agents", withRow(rows, added));
            setAdded("");
          }}
        >
          Add the ADS
        </button>
      </div>
      <NotInstalled agents={agents} />
    </Section>
  );
}
