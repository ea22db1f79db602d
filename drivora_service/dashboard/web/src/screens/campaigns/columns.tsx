import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { Sparkline } from "../../components/charts/Sparkline";
import type { Column } from "../../components/DataTable";
import { Mark } from "../../components/Mark";
import { count, duration, fixed } from "../../components/numbers";
import { Progress } from "../../components/Progress";
import { Actions } from "./Actions";
import { useDiscoveries } from "./discoveries";
import { lookOfSearch, shortName } from "./state";

type Campaign = Schemas["CampaignSummary"];

const POINTS = 40;

function Spark({ campaign }: { readonly campaign: Campaign }) {
  const { data } = useDiscoveries(campaign.id, POINTS, 1, campaign.simulations > 0);
  if (!data) return null;
  const avoidable = data.avoidable.at(-1) ?? 0;
  const others = data.others.at(-1) ?? 0;
  return (
    <Sparkline
      at={[...data.at, data.simulations]}
      lower={[...data.avoidable, avoidable]}
      upper={[...data.others, others]}
      end={data.budget}
      label={`Failures against simulations: ${avoidable} that count, ${others} others`}
    />
  );
}

function First({ campaign }: { readonly campaign: Campaign }) {
  const { data } = useDiscoveries(campaign.id, POINTS, 1, campaign.simulations > 0);
  if (!data) return null;
  return data.first_failure === null ? <span className="quiet">none</span> : data.first_failure;
}

/** Returns the candidates with failures that do not count: no ego at fault, or not avoidable. */
function others({ counts }: Campaign): number {
  return counts.violating - (counts.avoidable ?? 0);
}

export const COLUMNS: readonly Column<Campaign>[] = [
  {
    id: "name",
    title: "Campaign",
    width: "minmax(160px, 2fr)",
    cell: ({ id, name, cell }) => (
      <Link to="/campaigns/$id" params={{ id }} search={{}} title={name}>
        {shortName(name, cell) || id}
      </Link>
    ),
  },
  {
    id: "state",
    title: "State",
    width: "104px",
    cell: ({ state, request, message }) => (
      <span title={message || undefined}>
        <Mark {...lookOfSearch(state, request)} />
      </span>
    ),
  },
  { id: "tester", title: "Method", width: "100px", cell: ({ tester }) => tester },
  { id: "agent", title: "ADS", width: "104px", cell: (one) => <Ads of={one} /> },
  {
    id: "scene",
    title: "Scene",
    width: "minmax(100px, 0.9fr)",
    cell: ({ cell, town }) => cell?.scenario ?? town,
  },
  {
    id: "progress",
    title: "Simulations",
    width: "152px",
    cell: ({ simulations, budget }) => <Progress done={simulations} of={budget} />,
  },
  {
    id: "avoidable",
    title: "Counting",
    hint: "Simulations with a failure that counts: an ego was at fault and it was avoidable",
    width: "78px",
    numeric: true,
    cell: ({ id, counts }) =>
      counts.avoidable === null ? (
        <span title="Judged before this was recorded">unknown</span>
      ) : counts.avoidable === 0 ? (
        <span className="quiet">0</span>
      ) : (
        <Link
          className="bad"
          to="/campaigns/$id"
          params={{ id }}
          search={{ tab: "failures", accountability: "avoidable" }}
        >
          {count(counts.avoidable)}
        </Link>
      ),
  },
  {
    id: "others",
    title: "Other",
    hint: "Simulations with other failures only: unavoidable, undetermined, or no ego at fault",
    width: "52px",
    numeric: true,
    cell: (campaign) =>
      others(campaign) === 0 ? (
        <span className="quiet">0</span>
      ) : (
        <Link to="/campaigns/$id" params={{ id: campaign.id }} search={{ tab: "failures" }}>
          {count(others(campaign))}
        </Link>
      ),
  },
  {
    id: "first",
    title: "First",
    hint: "Simulations up to the first failure, itself included",
    width: "54px",
    numeric: true,
    cell: (campaign) => <First campaign={campaign} />,
  },
  {
    id: "spark",
    title: "Found",
    hint: "Failures against simulations: red those that count, grey all",
    width: "100px",
    cell: (campaign) => <Spark campaign={campaign} />,
  },
  {
    id: "rate",
    title: "Per s",
    hint: "Simulations a second of work",
    width: "54px",
    numeric: true,
    cell: ({ rate }) => fixed(rate, 1),
  },
  {
    id: "left",
    title: "Left",
    hint: "Time left at this rate",
    width: "88px",
    numeric: true,
    cell: ({ state, left_s }) => (state === "running" && left_s !== null ? duration(left_s) : ""),
  },
  {
    id: "actions",
    title: "",
    width: "150px",
    cell: ({ id, name, state, request }) => (
      <Actions kind="campaign" id={id} name={name} state={state} request={request} small />
    ),
  },
];
