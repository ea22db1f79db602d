import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useEffect } from "react";
import type { JsonObject } from "../../components/fields/pointers";
import { duration } from "../../components/numbers";
import { useScope } from "../../shell/session";
import { useKnownRates } from "./catalogues";
import type { Draft, Kind } from "./draft";
import { estimated } from "./estimate";
import { Outcome } from "./Outcome";
import { requestOf } from "./starting";
import { forgetDraft } from "./useDraft";
import type { Validation } from "./useValidation";
import { workOf } from "./work";

/** Starts what a form holds, and opens it. */
export function Start<
  Answer extends { readonly notes: readonly string[] },
  Started extends { readonly id: string },
>({
  kind,
  counted,
  draft,
  document,
  validation,
  post,
  ready,
}: {
  readonly kind: Kind;
  /** What counts as a failure, in words. */
  readonly counted: string;
  readonly draft: Draft;
  readonly document: JsonObject;
  readonly validation: Validation<Answer>;
  readonly post: (document: JsonObject, request: string) => Promise<Started>;
  /** What can be started, in words. */
  readonly ready: (answer: Answer) => string;
}) {
  const navigate = useNavigate();
  const queries = useQueryClient();
  const { maySubmit } = useScope();
  const starting = useMutation({
    mutationFn: () => post(document, requestOf(document)),
    onSuccess: (started) => {
      const { id } = started;
      forgetDraft(kind);
      queries.setQueryData([kind, id], started);
      void queries.invalidateQueries({ queryKey: [kind, "list"] });
      if (kind === "campaign") void navigate({ to: "/campaigns/$id", params: { id }, search: {} });
      else void navigate({ to: "/studies/$id", params: { id }, search: {} });
    },
  });
  const canStart =
    maySubmit &&
    validation.answer !== undefined &&
    validation.isFresh &&
    !starting.isPending &&
    !starting.isSuccess;
  const { mutate } = starting;
  useEffect(() => {
    const start = (event: KeyboardEvent) => {
      if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey) || !canStart) return;
      event.preventDefault();
      mutate();
    };
    window.addEventListener("keydown", start);
    return () => window.removeEventListener("keydown", start);
  }, [canStart, mutate]);
  return (
    <Outcome
      action={`Start the ${kind}`}
      counted={counted}
      hasScenario={draft.scenarios.length > 0}
      validation={validation}
      ready={ready}
      estimate={<Duration kind={kind} draft={draft} />}
      canStart={canStart}
      error={starting.error}
      onStart={() => mutate()}
    />
  );
}

/** How long it will take, as far as earlier campaigns tell. */
function Duration({ kind, draft }: { readonly kind: Kind; readonly draft: Draft }) {
  const work = workOf(kind, draft);
  const estimate = estimated(work, useKnownRates());
  const isOne = new Set(work.map(({ agent }) => agent)).size === 1;
  const whom = isOne ? "this ADS" : estimate ? "these ADSs" : "one of these ADSs";
  if (work.length === 0) return null;
  return (
    <p className="quiet">
      {estimate
        ? `About ${duration(roughly(estimate.seconds))}, by the ${
            estimate.campaigns === 1
              ? "rate of an earlier campaign"
              : `rates of ${estimate.campaigns} earlier campaigns`
          } with ${whom}; longer if the workers have other work.`
        : `How long it takes is not known: no campaign with ${whom} has finished here.`}
    </p>
  );
}

/** Returns seconds without digits that an estimate does not have. */
function roughly(seconds: number): number {
  if (seconds < 60) return Math.max(5, Math.ceil(seconds / 5) * 5);
  return seconds < 3600 ? Math.ceil(seconds / 60) * 60 : Math.ceil(seconds / 600) * 600;
}
