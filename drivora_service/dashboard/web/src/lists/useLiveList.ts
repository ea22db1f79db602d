import {
  type InfiniteData,
  keepPreviousData,
  useInfiniteQuery,
  useQueryClient,
} from "@tanstack/react-query";
import { useCallback, useEffect, useRef, useState } from "react";
import { listen } from "../live/hub";
import type { ChangeKind } from "../live/messages";
import { newRows, type Rows, renewed, settled } from "./merge";
import type { Page } from "./useList";

const GATHER_MS = 1000;
const MOST_PAGES_AT_ONCE = 4;

interface Options<Row> {
  readonly key: readonly unknown[];
  readonly kind: ChangeKind;
  readonly ask: (pageToken: string | undefined) => Promise<Page<Row>>;
  readonly idOf: (row: Row) => string;
  /** Whether the pointer is over the rows: they keep their places then. */
  readonly held: boolean;
  /** Whether new rows come first; else they come at the end, and are found there. */
  readonly newestFirst: boolean;
}

interface Pages<Row> {
  readonly pages: readonly Page<Row>[];
  readonly pageParams: readonly unknown[];
}

/** A list that is read page by page, and renewed where it changed, without rows that jump.
 *
 * Only pages with changed rows are asked for again. New rows are counted, and inserted when the
 * reader says so.
 */
export function useLiveList<Row>(options: Options<Row>) {
  const { key, kind, idOf, newestFirst } = options;
  const queries = useQueryClient();
  const query = useInfiniteQuery({
    // Not the key that changes touch: this hook renews what it shows by itself.
    queryKey: ["shown", ...key],
    queryFn: ({ pageParam }) => options.ask(pageParam || undefined),
    initialPageParam: "",
    getNextPageParam: (page: Page<Row>) => page.next_page_token || undefined,
    placeholderData: keepPreviousData,
    gcTime: 0,
  });
  const { data } = query;
  const [shown, setShown] = useState<Rows<Row>>({ rows: [], left: new Set() });
  const [news, setNews] = useState<readonly Row[]>([]);
  const [source, setSource] = useState<Pages<Row>>();
  if (data && data !== source) {
    // More pages were read, or all were read anew: rows that were renewed keep their new state.
    const grown = source && data.pages[0] === source.pages[0];
    setSource(data);
    const from = grown ? source.pages.length : 0;
    const added = data.pages.slice(from).flatMap((page) => page.items);
    setShown(
      grown
        ? { rows: [...shown.rows, ...added], left: shown.left }
        : { rows: added, left: new Set() },
    );
    if (!grown) setNews([]);
  }
  const latest = useRef({ shown, news, data, ask: options.ask, newestFirst });
  latest.current = { shown, news, data, ask: options.ask, newestFirst };

  const hash = JSON.stringify(key);
  const again = useCallback(() => {
    // Of a long list only the beginning is read anew: the rest follows as the reader scrolls.
    queries.setQueryData<InfiniteData<Page<Row>>>(
      ["shown", ...(JSON.parse(hash) as unknown[])],
      (now) => now && { pages: now.pages.slice(0, 1), pageParams: now.pageParams.slice(0, 1) },
    );
    void query.refetch();
  }, [queries, hash, query.refetch]);
  useEffect(() => {
    let changed = new Set<string>();
    let timer: ReturnType<typeof setTimeout> | undefined;
    let over = false;
    const renew = async () => {
      const ids = changed;
      changed = new Set();
      const { data: pages, ask } = latest.current;
      if (!pages) return;
      const asked = tokensOf(pages, ids, idOf).slice(0, MOST_PAGES_AT_ONCE);
      const answers = await Promise.all(
        asked.map((token) => ask(token || undefined).catch(() => undefined)),
      );
      if (over) return;
      const fresh = answers.flatMap((answer) => answer?.items ?? []);
      const covered = coveredBy(pages, asked, answers, ids, idOf);
      setShown((now) => renewed(now, fresh, covered, idOf));
      const first = answers[asked.indexOf("")];
      if (!first) return;
      if (latest.current.shown.rows.length === 0) {
        // Nothing can jump where nothing is shown.
        if (first.items.length > 0) again();
      } else if (latest.current.newestFirst)
        setNews(newRows(latest.current.shown.rows, first.items, idOf));
    };
    const stop = listen((told) => {
      if (told.type === "reset") again();
      if (told.type !== "changes") return;
      const mine = told.changes.filter((change) => change.kind === kind);
      if (mine.length === 0) return;
      for (const { id } of mine) changed.add(id);
      timer ??= setTimeout(() => {
        timer = undefined;
        void renew();
      }, GATHER_MS);
    });
    return () => {
      over = true;
      stop();
      clearTimeout(timer);
    };
  }, [kind, idOf, again]);

  const { held } = options;
  useEffect(() => {
    if (!held) setShown((now) => settled(now, idOf));
  }, [held, idOf]);

  const insertNews = useCallback(() => {
    const { news: rows } = latest.current;
    setNews([]);
    // A whole page of new rows may have more behind it: the list is read anew then.
    if (latest.current.data && rows.length >= (latest.current.data.pages[0]?.items.length ?? 0))
      again();
    else setShown((now) => ({ rows: [...rows, ...now.rows], left: now.left }));
  }, [again]);

  return {
    query,
    rows: shown.rows,
    left: shown.left,
    news: news.length,
    insertNews,
    more: () => {
      if (query.hasNextPage && !query.isFetchingNextPage) void query.fetchNextPage();
    },
  };
}

/** Returns the tokens of the pages that have a changed row; the first page always, for new rows. */
function tokensOf<Row>(
  pages: Pages<Row>,
  ids: ReadonlySet<string>,
  idOf: (row: Row) => string,
): readonly string[] {
  return pages.pages.flatMap((page, place) =>
    place === 0 || page.items.some((row) => ids.has(idOf(row)))
      ? [String(pages.pageParams[place] ?? "")]
      : [],
  );
}

/** Returns the changed ids whose page was answered: one that the answer lacks has left the list. */
function coveredBy<Row>(
  pages: Pages<Row>,
  asked: readonly string[],
  answers: readonly (Page<Row> | undefined)[],
  ids: ReadonlySet<string>,
  idOf: (row: Row) => string,
): ReadonlySet<string> {
  const covered = new Set<string>();
  pages.pages.forEach((page, place) => {
    const at = asked.indexOf(String(pages.pageParams[place] ?? ""));
    // A page of which new rows have pushed others out does not show that those have left.
    const answer = at < 0 ? undefined : answers[at];
    if (!answer || answer.items.length > page.items.length) return;
    const pushed = answer.next_page_token && answer.items.length === page.items.length;
    const last = answer.items.at(-1);
    const end = pushed && last ? page.items.findIndex((row) => idOf(row) === idOf(last)) : Infinity;
    page.items.forEach((row, index) => {
      if (ids.has(idOf(row)) && index <= end) covered.add(idOf(row));
    });
  });
  return covered;
}
