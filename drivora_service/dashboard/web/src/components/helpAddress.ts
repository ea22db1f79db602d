import { addressOf } from "../service";
/** Returns where the service has a page of the documentation, such as `docs/how-to/x.md#y`. */
export function helpAddress(page: string): string {
  const name = /([^/]+)\.md(?:#.*)?$/u.exec(page)?.[1] ?? "";
  return addressOf(`/help/${name}`);
}
