import { useQuery } from "@tanstack/react-query";
import { Link, useParams, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { count } from "../../components/numbers";
import { Loading, Refused } from "../../components/States";
import { Tabs } from "../../components/Tabs";
import { Warnings } from "../../components/Warnings";
import { addressOf } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { Actions } from "../campaigns/Actions";
import { lookOfSearch } from "../campaigns/state";
import { AgainWith } from "../compose/SearchFrom";
import { Ancestry } from "./Ancestry";
import { Coverage } from "./Coverage";
import { Evaluations } from "./Evaluations";
import { Facts } from "./Facts";
import { Found } from "./Found";
import { Judged } from "./Judged";
import { Kinds } from "./Kinds";
import { Newest } from "./Newest";
import { Objectives } from "./Objectives";
import { Settings } from "./Settings";

export function Campaign() {
  const { id } = useParams({ from: "/campaigns/$id" });
  const query = useQuery({
    queryKey: ["campaign", id],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}", { params: { path: { campaign_id: id } } }),
      ),
  });
  useTitle(query.data?.name ?? "Campaign");
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  return <Loaded campaign={query.data} />;
}

function Loaded({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const { id, name, state, request, message } = campaign;
  const tabs = [
    { name: "failures", title: "Failures", count: campaign.counts.violating },
    { name: "objectives", title: "Objectives" },
    { name: "coverage", title: "Coverage" },
    { name: "ancestry", title: "Ancestry" },
    { name: "evaluations", title: "Evaluations", count: campaign.counts.evaluations },
    { name: "settings", title: "Settings" },
  ];
  const open = tabs.find((tab) => tab.name === firstOf(search, "tab"))?.name ?? "failures";
  return (
    <>
      <div className="head">
        <h1>{name || id}</h1>
        <Mark {...lookOfSearch(state, request)} />
        <div className="actions">
          <Tables id={id} />
          <AgainWith kind="campaign" id={id} />
          <Actions kind="campaign" id={id} name={name} state={state} request={request} />
        </div>
        <Facts campaign={campaign} />
      </div>
      {message && (
        <section className="state error" role="alert">
          <p>{message}</p>
        </section>
      )}
      <Answer campaign={campaign} />
      <Warnings warnings={campaign.warnings} missing={campaign.missing_results} />
      <Judged campaign={campaign} />
      <div className="two wide-first">
        <section className="panel">
          <div className="inside">
            <Found campaign={campaign} />
          </div>
        </section>
        <section className="panel newest-panel">
          <header>
            <h2>Newest failures</h2>
          </header>
          <div className="inside">
            <Newest campaign={campaign} />
          </div>
        </section>
      </div>
      <Tabs tabs={tabs} open={open} search={search} />
      {open === "failures" && <Kinds campaign={campaign} />}
      {open === "objectives" && <Objectives campaign={campaign} />}
      {open === "coverage" && <Coverage campaign={campaign} />}
      {open === "ancestry" && <Ancestry campaign={campaign} />}
      {open === "evaluations" && <Evaluations campaign={campaign} />}
      {open === "settings" && <Settings campaign={campaign} />}
    </>
  );
}

/** The numbers into a spreadsheet. */
function Tables({ id }: { readonly id: string }) {
  return (
    <span className="doing">
      CSV:
      {(["evaluations", "failures"] as const).map((table) => (
        <a
          key={table}
          href={addressOf(`/api/v1/campaigns/${id}/tables/${table}`)}
          download={`${table}.csv`}
        >
          {table}
        </a>
      ))}
    </span>
  );
}

/** Simulations that are apart from the avoidable ones by the strongest of their violations. */
function beside(counts: Schemas["CampaignCounts"]): string {
  const parts = [
    [counts.unavoidable, "at fault but not avoidable"],
    [counts.undetermined, "of undetermined fault"],
    [counts.preventable, "not at fault, but avoidable"],
    [counts.not_at_fault, "not at fault"],
  ] as const;
  const told = parts.flatMap(([number, words]) => (number ? [`${count(number)} ${words}`] : []));
  return told.length > 0 ? `; simulations ${told.join(", ")}` : "";
}

/** How the search stands, in one sentence. */
function Answer({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const { counts, simulations, kinds } = campaign;
  const lost = counts.failed + counts.invalid;
  const filter = (accountability: string) => ({ tab: "failures", accountability });
  return (
    <p className="answer">
      {counts.violating === 0 ? (
        `No failure that it counts in ${count(simulations)} simulations`
      ) : (
        <>
          <Link to="." search={{ tab: "evaluations", violating: "true" }} resetScroll={false}>
            {count(counts.violating)} of {count(simulations)} simulations
          </Link>{" "}
          failed, in {kinds.length} {kinds.length === 1 ? "way" : "ways"}:{" "}
          <Link
            className={counts.avoidable ? "bad" : undefined}
            to="."
            search={filter("avoidable")}
            resetScroll={false}
          >
            {counts.avoidable === null ? "an unknown number" : count(counts.avoidable)} at fault and
            avoidable
          </Link>
        </>
      )}
      {beside(counts)}
      {lost > 0 && (
        <>
          {"; "}
          <Link
            to="."
            search={{ tab: "evaluations", status: counts.failed ? "failed" : "invalid" }}
            resetScroll={false}
          >
            {count(lost)} candidates without a result
          </Link>
        </>
      )}
      .
    </p>
  );
}
