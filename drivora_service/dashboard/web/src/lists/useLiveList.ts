import {
  type InfiniteData,
  keepPreviousData,
  useInfiniteQuery,
  useQueryClient,
} from "@tanstack/react-query";
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { listen } from "../live/hub";
import type { Change, ChangeKind } from "../live/messages";
import {
  coverage,
  inserted,
  newRows,
  type Overlay,
  renewed,
  rowsOf,
  settled,
  UNCHANGED,
} from "./merge";
import type { Page } from "./useList";

const GATHER_MS = 1000;
const MOST_PAGES_AT_ONCE = 4;

type Owned = Exclude<ChangeKind, "workers">;

interface Options<Row> {
  readonly key: readonly unknown[];
  readonly kind: Owned;
  readonly ask: (pageToken: string | undefined) => Promise<Page<Row>>;
  readonly idOf: (row: Row) => string;
  /** Whether the pointer is over the rows: they keep their places then. */
  readonly held: boolean;
  /** Whether new rows come first; else they come at the end, and are found there. */
  readonly newestFirst: boolean;
}

interface Changed<Row> {
  readonly base: Page<Row> | undefined;
  readonly overlay: Overlay<Row>;
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
  const { key, kind, idOf } = options;
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
  const base = data?.pages[0];
  const [changed, setChanged] = useState<Changed<Row>>({ base: undefined, overlay: UNCHANGED });
  // What has changed counts for the pages that were read before, not for those read since.
  const overlay: Overlay<Row> = changed.base === base ? changed.overlay : UNCHANGED;
  const read = useMemo(() => data?.pages.flatMap((page) => page.items) ?? [], [data]);
  const rows = useMemo(() => rowsOf(read, overlay, idOf), [read, overlay, idOf]);
  const change = useCallback((by: (now: Overlay<Row>) => Overlay<Row>) => {
    const { base: of } = latest.current;
    setChanged((now) => ({ base: of, overlay: by(now.base === of ? now.overlay : UNCHANGED) }));
  }, []);
  const latest = useRef({ ...options, rows, data, base, inserted: overlay.inserted });
  latest.current = { ...options, rows, data, base, inserted: overlay.inserted };

  const hash = JSON.stringify(key);
  const { refetch } = query;
  const again = useCallback(() => {
    // Of a long list only the beginning is read anew: the rest follows as the reader scrolls.
    queries.setQueryData<InfiniteData<Page<Row>>>(
      ["shown", ...(JSON.parse(hash) as unknown[])],
      (now) => now && { pages: now.pages.slice(0, 1), pageParams: now.pageParams.slice(0, 1) },
    );
    setChanged({ base: undefined, overlay: UNCHANGED });
    void refetch();
  }, [queries, hash, refetch]);

  useEffect(() => {
    let ids = new Set<string>();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const renew = async () => {
      timer = undefined;
      const touched = ids;
      ids = new Set();
      const { data: pages, ask, base: of } = latest.current;
      if (!pages) return;
      const asked = tokensOf(pages, touched, idOf).slice(0, MOST_PAGES_AT_ONCE);
      const answers = await Promise.all(
        asked.map((token) => ask(token || undefined).catch(() => undefined)),
      );
      if (of !== latest.current.base) return;
      const first = answers[asked.indexOf("")];
      if (latest.current.rows.length === 0) {
        // Nothing can jump where nothing is shown.
        if (first && first.items.length > 0) again();
        return;
      }
      const fresh = answers.flatMap((answer) => answer?.items ?? []);
      const covered = coveredBy(
        withInserted(pages, latest.current.inserted),
        asked,
        answers,
        touched,
        idOf,
      );
      change((now) => {
        const next = renewed(now, fresh, covered, idOf);
        const found =
          first && latest.current.newestFirst
            ? newRows(latest.current.rows, first.items, idOf)
            : now.news;
        return { ...(latest.current.held ? next : settled(next)), news: found };
      });
    };
    const stop = listen((told) => {
      if (told.type === "reset") again();
      if (told.type !== "changes") return;
      const before = ids.size;
      for (const one of told.changes) {
        const id = changedOf(one, kind);
        if (id) ids.add(id);
      }
      if (ids.size > before) timer ??= setTimeout(() => void renew(), GATHER_MS);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, [kind, idOf, again, change]);

  const { held } = options;
  useEffect(() => {
    if (!held) change(settled);
  }, [held, change]);

  return {
    query,
    rows,
    left: overlay.left,
    news: overlay.news.length,
    insertNews: () => {
      // A whole page of new rows may have more behind it: the list is read anew then.
      if (overlay.news.length >= (base?.items.length ?? 0)) again();
      else change(inserted);
    },
    more: () => {
      if (query.hasNextPage && !query.isFetchingNextPage) void query.fetchNextPage();
    },
  };
}

/** Returns the object of a kind that a change touches: a run's change also touches its batch. */
function changedOf(change: Change, kind: Owned): string | undefined {
  if (change.kind === kind) return change.id;
  // What a run found may be in any group of failures.
  if (kind === "group") return change.kind === "run" ? change.id : undefined;
  // Nothing belongs to a run, a minimisation or a run of a suite.
  return kind === "run" || kind === "minimization" || kind === "suite"
    ? undefined
    : change[`${kind}_id`];
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

/** New rows that were inserted are part of the first page from then on. */
function withInserted<Row>(pages: Pages<Row>, rows: readonly Row[]): Pages<Row> {
  const [first, ...others] = pages.pages;
  if (!first || rows.length === 0) return pages;
  return { ...pages, pages: [{ ...first, items: [...rows, ...first.items] }, ...others] };
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
    const answer = at < 0 ? undefined : answers[at];
    if (!answer) return;
    const end = coverage(page.items, answer.items, Boolean(answer.next_page_token), idOf);
    for (const row of page.items.slice(0, end)) if (ids.has(idOf(row))) covered.add(idOf(row));
  });
  return covered;
}
