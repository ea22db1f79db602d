import { type CountClass, classText, SHADES } from "../../../components/charts/countClasses";
import type { Plan } from "../../../components/charts/placeMap";
import { scaleBar } from "../../../roads/camera";
import { FailureSign } from "./FailureMarks";
import type { Use } from "./laneUse";

const LEAST_BOX_PX = 56;
const DIGIT_PX = 6.8;
const SIGNS_PX = 214;

/** Returns the pixels of a class with its counts in words. */
function boxOf(classes: readonly CountClass[]): number {
  const digits = Math.max(0, ...classes.map((one) => classText(one).length));
  return Math.max(digits * DIGIT_PX + 6, LEAST_BOX_PX);
}

/** Returns whether the signs need a row of their own below the colours. */
function isNarrow(classes: readonly CountClass[], width: number): boolean {
  return width < (SHADES + 1) * boxOf(classes) + SIGNS_PX;
}

/** Returns the height of the legend below a map. */
export function legendHeight(classes: readonly CountClass[], width: number): number {
  return isNarrow(classes, width) ? 78 : 58;
}

const TITLES: Readonly<Record<Use, string>> = {
  egos: "ways of egos over a piece of a lane",
  actors: "ways and places of all actors on a piece of a lane",
};

/** What the colours and signs of a map mean, and how long a metre is. */
export function LaneUseLegend({
  classes,
  use,
  plan,
  width,
}: {
  readonly classes: readonly CountClass[];
  readonly use: Use;
  readonly plan: Plan;
  readonly width: number;
}) {
  const box = boxOf(classes);
  const metres = scaleBar(plan.scale);
  const bar = metres * plan.scale;
  return (
    <g transform={`translate(0,${plan.height})`}>
      <text className="title" y="18">
        {TITLES[use]}
      </text>
      <Step left={0} size={box} look="unused" text="0" thin />
      {classes.map((one, place) => (
        <Step
          key={one.from}
          left={(place + 1) * box}
          size={box}
          look={`use-${one.shade}`}
          text={classText(one)}
        />
      ))}
      <g
        transform={
          isNarrow(classes, width) ? "translate(6,68)" : `translate(${width - SIGNS_PX},33)`
        }
      >
        <FailureSign isAvoidable />
        <text x="9" dy="0.32em">
          avoidable failure
        </text>
        <g transform="translate(128,0)">
          <FailureSign isAvoidable={false} />
          <text x="9" dy="0.32em">
            other failure
          </text>
        </g>
      </g>
      <g transform={`translate(${width - 1},-8)`}>
        <rect className="behind" x={-bar} y="-17" width={bar} height="17" />
        <path className="scale" d={`M${-bar},-4v4H0v-4`} />
        <text x={-bar / 2} y="-5" textAnchor="middle">
          {metres} m
        </text>
      </g>
    </g>
  );
}

function Step({
  left,
  size,
  look,
  text,
  thin = false,
}: {
  readonly left: number;
  readonly size: number;
  readonly look: string;
  readonly text: string;
  readonly thin?: boolean;
}) {
  return (
    <g transform={`translate(${left},33)`}>
      <path className={`lane ${look}`} strokeWidth={thin ? 4 : 9} d={`M0,0H${size - 2}`} />
      <text x={(size - 2) / 2} y="19" textAnchor="middle">
        {text}
      </text>
    </g>
  );
}
