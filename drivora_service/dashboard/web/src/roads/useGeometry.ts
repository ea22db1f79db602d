import { useQuery } from "@tanstack/react-query";
import { geometryQuery } from "./geometryQuery";

export function useGeometry(name: string) {
  return useQuery(geometryQuery(name));
}
