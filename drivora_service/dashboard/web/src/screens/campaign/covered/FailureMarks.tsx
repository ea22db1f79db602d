import { memo } from "react";
import type { Plan } from "../../../components/charts/placeMap";
import type { FailurePlace } from "./failurePlaces";

export const CROSS = "M-3.6,-3.6L3.6,3.6M-3.6,3.6L3.6,-3.6";
export const TRIANGLE = "M0,-4L4,3H-4Z";

/** Failures where they began: crosses count, triangles do not. */
export const FailureMarks = memo(function FailureMarks({
  places,
  plan: { toX, toY },
}: {
  readonly places: readonly FailurePlace[];
  readonly plan: Plan;
}) {
  // The avoidable ones are drawn last.
  const ordered = places.toSorted((a, b) => Number(a.isAvoidable) - Number(b.isAvoidable));
  return ordered.map(({ failure, x, y, isAvoidable }) => (
    <g
      key={`${failure.evaluation} ${failure.place}`}
      data-id={failure.evaluation}
      transform={`translate(${toX(x).toFixed(1)},${toY(y).toFixed(1)})`}
    >
      <title>{`evaluation ${failure.evaluation}: ${failure.verdict.message}`}</title>
      <circle className="sensor" r="8" />
      <FailureSign isAvoidable={isAvoidable} />
    </g>
  ));
});

/** The sign of a failure, with a rim that parts it from what is below. */
export function FailureSign({ isAvoidable }: { readonly isAvoidable: boolean }) {
  const shape = isAvoidable ? CROSS : TRIANGLE;
  return (
    <>
      <path className="rim" d={shape} />
      <path className={`point ${isAvoidable ? "bad" : "lost"}`} d={shape} />
    </>
  );
}
