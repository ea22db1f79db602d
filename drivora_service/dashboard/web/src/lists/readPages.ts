import type { Page } from "./useList";

/** The rows of a list, and whether there are more than were wanted. */
export interface Read<Row> {
  readonly rows: readonly Row[];
  readonly more: boolean;
}

/** Reads a list page by page until its end, or until at least so many rows are read. */
export async function readPages<Row>(
  ask: (pageToken: { readonly page_token?: string }) => Promise<Page<Row>>,
  wanted = Number.POSITIVE_INFINITY,
): Promise<Read<Row>> {
  const rows: Row[] = [];
  let token = "";
  do {
    const page = await ask(token ? { page_token: token } : {});
    rows.push(...page.items);
    token = page.next_page_token ?? "";
  } while (token && rows.length < wanted);
  return { rows, more: token !== "" };
}
