import { keepPreviousData, useInfiniteQuery } from "@tanstack/react-query";

export interface Page<Row> {
  readonly items: readonly Row[];
  readonly next_page_token?: string | null;
}

/** Reads a list page by page as the reader scrolls. */
export function useList<Row>(
  key: readonly unknown[],
  ask: (pageToken: string | undefined) => Promise<Page<Row>>,
) {
  const query = useInfiniteQuery({
    queryKey: key,
    queryFn: ({ pageParam }) => ask(pageParam || undefined),
    initialPageParam: "",
    getNextPageParam: (page: Page<Row>) => page.next_page_token || undefined,
    placeholderData: keepPreviousData,
  });
  const rows = query.data?.pages.flatMap((page) => page.items) ?? [];
  const more = () => {
    if (query.hasNextPage && !query.isFetchingNextPage) void query.fetchNextPage();
  };
  return { query, rows, more };
}
