import { useQuery } from "@tanstack/react-query";
import { addressOf } from "../../service";
import { readArrow } from "./arrowTable";
import { PerceivedActors } from "./perception";

/** What an ego perceived; asked for only when it is shown. */
export function usePerception(
  run: string,
  ego: number,
  steps: number,
  actors: number,
  wanted: boolean,
) {
  return useQuery({
    queryKey: ["run", run, "perception", ego],
    queryFn: async ({ signal }) =>
      new PerceivedActors(
        await readArrow(
          addressOf(`/api/v1/runs/${run}/perception?ego=${ego}`),
          "drivora_perception",
          signal,
        ),
        steps,
        actors,
      ),
    enabled: wanted,
    structuralSharing: false,
  });
}
