import { useQueries, useQuery } from "@tanstack/react-query";
import { Link, useSearch } from "@tanstack/react-router";
import { firstOf, valuesOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { Choice } from "../../components/Choice";
import { Empty, Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { Boxes } from "../study/Boxes";
import { Differing } from "../study/Differing";
import { Effects } from "../study/Effects";
import { MEASURES, measureOf } from "../study/measures";
import { CurvesTogether } from "./CurvesTogether";
import { SideBySide } from "./SideBySide";

/** Campaigns side by side: only what differs, then their curves, then their methods. */
export function Compare() {
  useTitle("Compare campaigns");
  const search = useSearch({ from: "/compare" });
  const ids = valuesOf(search, "campaign");
  const found = useQueries({
    queries: ids.map((id) => ({
      queryKey: ["campaign", id],
      queryFn: async () =>
        body(
          await api.GET("/api/v1/campaigns/{campaign_id}", {
            params: { path: { campaign_id: id } },
          }),
        ),
    })),
    combine: (answers) => ({
      error: answers.find(({ error }) => error)?.error,
      campaigns: answers.flatMap(({ data }) => (data ? [data] : [])),
    }),
  });
  if (ids.length < 2)
    return (
      <Empty title="Nothing to compare yet">
        <p>
          Select two or more <Link to="/campaigns">campaigns</Link> with <kbd>x</kbd>, and press{" "}
          <kbd>c</kbd>.
        </p>
      </Empty>
    );
  if (found.error) return <Refused error={found.error} />;
  if (found.campaigns.length < ids.length) return <Loading />;
  return <Loaded campaigns={found.campaigns} />;
}

function Loaded({ campaigns }: { readonly campaigns: readonly Schemas["Campaign"][] }) {
  return (
    <>
      <div className="head">
        <h1>{campaigns.length} campaigns compared</h1>
      </div>
      <SideBySide campaigns={campaigns} />
      <section className="panel">
        <div className="inside">
          <CurvesTogether campaigns={campaigns} />
        </div>
      </section>
      <Methods campaigns={campaigns} />
      <section className="panel">
        <div className="inside stack">
          <Differing
            title="Settings that differ"
            names={campaigns.map(
              ({ tester, cell }, place) => `${place + 1} ${cell?.method ?? tester}`,
            )}
            documents={campaigns.map(({ document: { name: _name, ...rest }, versions }) => ({
              ...rest,
              versions,
            }))}
          />
        </div>
      </section>
    </>
  );
}

/** Methods against each other, as far as the campaigns can be compared so. */
function Methods({ campaigns }: { readonly campaigns: readonly Schemas["Campaign"][] }) {
  const search = useSearch({ from: "/compare" });
  const measure = measureOf(firstOf(search, "measure"));
  const baseline = firstOf(search, "baseline");
  const ids = campaigns.map(({ id }) => id);
  const finished = campaigns.every(({ state }) => state === "finished");
  const query = useQuery({
    queryKey: ["comparison", ids, baseline],
    enabled: finished,
    retry: false,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns:compare", {
          params: {
            query: {
              campaign: [...ids],
              measure: MEASURES.map(({ name }) => name),
              ...(baseline ? { baseline } : {}),
            },
          },
        }),
      ),
  });
  const methods = [...new Set(query.data?.campaigns.map(({ method }) => method))];
  return (
    <section className="panel">
      <header>
        <h2>Methods</h2>
        <Choice
          name="measure"
          title="By"
          value={measure.name}
          search={search}
          options={MEASURES.map(({ name, title }) => ({ value: name, text: title }))}
        />
        {methods.length > 1 && (
          <Choice
            name="baseline"
            title="Against"
            value={query.data?.baseline ?? ""}
            search={search}
            options={methods.map((method) => ({ value: method, text: method }))}
          />
        )}
      </header>
      <div className="inside stack">
        {!finished ? (
          <p className="quiet">Methods are compared by finished campaigns.</p>
        ) : query.isPending ? (
          <Loading />
        ) : query.isError ? (
          // Campaigns of one method, say, are shown side by side all the same.
          <p className="quiet">{query.error.message}</p>
        ) : (
          <>
            {query.data.notes.map((note) => (
              <p key={note} className="quiet">
                {note}
              </p>
            ))}
            <Effects
              differences={query.data.differences.filter((one) => one.measure === measure.name)}
              names={methods}
              title="Methods against the baseline"
              file="effects"
            />
            <Boxes
              repetitions={query.data.campaigns.map((figures) => ({
                method: figures.method,
                place: figures.scenario,
                campaign: figures.campaign,
                value: measure.value(figures),
              }))}
              methods={methods}
              measure={measure}
              file="repetitions"
            />
          </>
        )}
      </div>
    </section>
  );
}
