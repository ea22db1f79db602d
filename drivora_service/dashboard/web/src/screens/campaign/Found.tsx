import type { Schemas } from "../../api/client";
import { type CurveBand, Curves } from "../../components/charts/Curves";
import type { Numbers } from "../../components/charts/export";
import { Figure } from "../../components/charts/Figure";
import { Refused } from "../../components/States";
import { type Discoveries, useDiscoveries } from "../campaigns/discoveries";
import { plain } from "../failures/words";
import { useBands } from "./bands";

/** Points of the curves of failures. */
export const CURVE_POINTS = 400;
const SHOWN_ORACLES = 4;

/** Failures against simulations, with the repetitions of Random in the same study behind them. */
export function Found({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const found = useDiscoveries(campaign.id, CURVE_POINTS, 1);
  const bands = useBands(campaign, CURVE_POINTS);
  if (found.isError) return <Refused error={found.error} />;
  const numbers = found.data ? numbersOf(found.data) : { columns: [], rows: [] };
  const random = bands.data?.bands[0];
  const behind: readonly CurveBand[] = random
    ? [
        {
          name: `Random, any (${random.campaigns.length} repetitions)`,
          look: "other",
          x: random.at,
          ...random.failing,
        },
        {
          name: "Random, avoidable",
          look: random.avoidable.high.some((number) => number > 0) ? "bad" : "other",
          x: random.at,
          ...random.avoidable,
        },
      ]
    : [];
  return (
    <Figure
      level={2}
      title="Failures against simulations"
      note={
        random
          ? "Solid: this campaign. Dashed with a band: median and quartiles of Random on the same scenario with the same ADS."
          : "Simulations with a failure so far. Avoidable ones: an ego was at fault, and a careful and competent driver avoids it."
      }
      file={`${campaign.id}-discoveries`}
      numbers={numbers}
    >
      {(width) =>
        found.data && (
          <Curves
            label={`Failures against simulations of ${campaign.name}`}
            width={width}
            height={campaign.counts.violating > 0 ? 300 : 150}
            names={190}
            curves={curvesOf(found.data)}
            bands={behind}
            xTitle="simulations"
            yTitle="simulations with a failure"
            xEnd={campaign.budget}
          />
        )
      }
    </Figure>
  );
}

function sum(a: readonly number[], b: readonly number[]): readonly number[] {
  return a.map((value, place) => value + (b[place] ?? 0));
}

function curvesOf(found: Discoveries) {
  const all = sum(found.avoidable, found.others);
  const x = [...found.at, found.simulations];
  const whole = (y: readonly number[]) => [...y, y.at(-1) ?? 0];
  const oracles = found.oracles.length > 1 ? found.oracles.slice(0, SHOWN_ORACLES) : [];
  return [
    { name: "any failure", look: "other", x, y: whole(all) },
    {
      name: "avoidable",
      look: found.avoidable.some((number) => number > 0) ? "bad" : "other",
      x,
      y: whole(found.avoidable),
    },
    ...oracles.map(({ name, avoidable, others }, place) => ({
      name: plain(name),
      look: `series-${place}`,
      x,
      y: whole(sum(avoidable, others)),
    })),
  ];
}

function numbersOf(found: Discoveries): Numbers {
  return {
    columns: [
      "simulations",
      "avoidable failures",
      "other failures",
      "kinds",
      ...found.oracles.map(({ name }) => name),
    ],
    rows: found.at.map((at, place) => [
      at,
      found.avoidable[place] ?? null,
      found.others[place] ?? null,
      found.different[place] ?? null,
      ...found.oracles.map(
        ({ avoidable, others }) => (avoidable[place] ?? 0) + (others[place] ?? 0),
      ),
    ]),
  };
}
