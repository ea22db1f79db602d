import type { Schemas } from "../../api/client";
import { count } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { Amounts } from "./covered/Amounts";
import { GeneSpace } from "./covered/GeneSpace";
import { Roads } from "./covered/Roads";
import { ScenarioKinds } from "./covered/ScenarioKinds";
import { useCoverage } from "./covered/useCovered";

/** What a campaign has tried: roads, kinds of scenarios, values of genes; and where it failed. */
export function Coverage({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const query = useCoverage(campaign);
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const { counted, evaluations, simulations, networks, genes, kinds, goesOn } = query.data;
  if (networks.length === 0)
    return (
      <Empty title="Nothing simulated so far">
        <p>Roads, genes and kinds of scenarios are counted from the first simulation on.</p>
      </Empty>
    );
  return (
    <>
      {counted < evaluations && (
        <p className="quiet" role="status">
          {count(counted)} of {count(evaluations)} evaluations are counted
          {goesOn ? "; the others follow." : "."}
        </p>
      )}
      <div className={networks.length > 1 ? "two several-maps" : "two wide-first"}>
        <Roads campaign={campaign} networks={networks} />
        <div className="stack">
          <Amounts campaign={campaign} />
          <ScenarioKinds kinds={kinds} simulations={simulations} />
        </div>
      </div>
      <GeneSpace campaign={campaign} genes={genes} />
    </>
  );
}
