import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { Menu } from "../../components/Menu";
import { useScope } from "../../shell/session";
import { isActive } from "../minimizations/minimization";
import { minimizable } from "./minimizable";
import { blameWords, oracleName, toneOf } from "./verdictWords";

/** Leads to the minimisation of a run, or to all of them; nothing if it was never minimised. */
export function Minimised({ run }: { readonly run: Schemas["Run"] }) {
  const { data } = useQuery({
    queryKey: ["minimization", "list", "of run", run.id],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/minimizations", { params: { query: { run: run.id, limit: 1 } } }),
      ),
    enabled: minimizable(run).length > 0,
  });
  const newest = data?.items[0];
  if (!newest) return null;
  if (data.next_page_token)
    return (
      <>
        {" · "}
        <Link to="/minimizations" search={{ run: run.id }}>
          its minimisations
        </Link>
      </>
    );
  return (
    <>
      {" · "}
      <Link to="/minimizations/$id" params={{ id: newest.id }} search={{}}>
        its minimisation{isActive(newest) && ", running"}
      </Link>
    </>
  );
}

/** Begins the minimisation of a failing run; of several oracles the reader chooses which. */
export function MinimizeRun({ run }: { readonly run: Schemas["Run"] }) {
  const failing = minimizable(run);
  const { maySubmit } = useScope();
  if (!maySubmit || failing.length === 0) return null;
  return <Begin runId={run.id} failing={failing} />;
}

function Begin({
  runId,
  failing,
}: {
  readonly runId: string;
  readonly failing: readonly Schemas["Verdict"][];
}) {
  const navigate = useNavigate();
  const queries = useQueryClient();
  const begin = useMutation({
    mutationFn: async (oracle: string) =>
      body(
        await api.POST("/api/v1/runs/{run_id}:minimize", {
          params: { path: { run_id: runId } },
          // The service has a default for whatever is not named.
          body: { oracle } as Schemas["MinimizationRequest"],
        }),
      ),
    onSuccess: (minimization) => {
      const { id } = minimization;
      queries.setQueryData(["minimization", id], minimization);
      void navigate({ to: "/minimizations/$id", params: { id }, search: {} });
    },
  });
  const [gravest, ...others] = failing;
  const title = "Search the smallest scenario that fails in the same way";
  return (
    <>
      {begin.isError && (
        <span role="alert" className="refusal">
          {begin.error.message}
        </span>
      )}
      {others.length === 0 ? (
        <button
          type="button"
          title={title}
          disabled={begin.isPending}
          onClick={() => gravest && begin.mutate(gravest.oracle)}
        >
          Minimise
        </button>
      ) : (
        <Menu label="Minimise" title={title} align="right">
          {(close) => (
            <>
              <p className="quiet note">Which violation must come again?</p>
              {failing.map((verdict) => (
                <button
                  key={verdict.oracle}
                  type="button"
                  className="item"
                  disabled={begin.isPending}
                  onClick={() => {
                    close();
                    begin.mutate(verdict.oracle);
                  }}
                >
                  <Mark sign="✕" tone={toneOf(verdict)} text={oracleName(verdict.oracle)} />
                  <span className="word quiet">{blameWords(verdict)}</span>
                </button>
              ))}
            </>
          )}
        </Menu>
      )}
    </>
  );
}
