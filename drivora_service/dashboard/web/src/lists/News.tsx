import { count } from "../components/numbers";

/** How many new rows wait to be inserted. */
export function News({ news, onInsert }: { readonly news: number; readonly onInsert: () => void }) {
  if (news === 0) return null;
  return (
    <button type="button" className="news primary" onClick={onInsert}>
      {count(news)} new
    </button>
  );
}
