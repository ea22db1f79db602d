import { useQueries } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { Curves } from "../../components/charts/Curves";
import { Figure } from "../../components/charts/Figure";
import { discoveriesQuery } from "../campaigns/discoveries";

const POINTS = 300;
const SHOWN = 6;

/** Failures against simulations of several campaigns in one figure. */
export function CurvesTogether({
  campaigns,
}: {
  readonly campaigns: readonly Schemas["Campaign"][];
}) {
  const [all, setAll] = useState(false);
  const shown = campaigns.slice(0, SHOWN);
  const found = useQueries({
    queries: shown.map(({ id }) => discoveriesQuery(id, POINTS, 1)),
    combine: (answers) => answers.map(({ data }) => data),
  });
  const curves = found.flatMap((one, place) => {
    if (!one) return [];
    const y = one.avoidable.map((value, at) => value + (all ? (one.others[at] ?? 0) : 0));
    return [
      {
        name: `${place + 1} ${shown[place]?.cell?.method ?? shown[place]?.tester ?? ""}`,
        look: `series-${place}`,
        x: [...one.at, one.simulations],
        y: [...y, y.at(-1) ?? 0],
      },
    ];
  });
  return (
    <>
      <label className="one">
        <input type="checkbox" checked={all} onChange={(event) => setAll(event.target.checked)} />
        with failures that do not count
      </label>
      <Figure
        level={2}
        title={all ? "Failures against simulations" : "Avoidable failures against simulations"}
        note={campaigns.length > SHOWN ? `The first ${SHOWN} campaigns.` : undefined}
        file="campaigns"
        numbers={{
          columns: ["campaign", "simulations", "simulations with a failure"],
          rows: curves.flatMap(({ name, x, y }) =>
            x.map((at, place) => [name, at, y[place] ?? null]),
          ),
        }}
      >
        {(width) => (
          <Curves
            label="Failures against simulations by campaign"
            width={width}
            height={300}
            curves={curves}
            xTitle="simulations"
            yTitle="simulations with a failure"
          />
        )}
      </Figure>
    </>
  );
}
