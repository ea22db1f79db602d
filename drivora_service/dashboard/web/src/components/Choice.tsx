import { useNavigate } from "@tanstack/react-router";
import type { Search } from "../address";

/** One of several views; the address holds the choice. */
export function Choice({
  name,
  title,
  label,
  value,
  options,
  search,
}: {
  readonly name: string;
  readonly title: string;
  /** What it is called where there is no title before it. */
  readonly label?: string;
  readonly value: string;
  readonly options: readonly { readonly value: string; readonly text: string }[];
  readonly search: Search;
}) {
  const navigate = useNavigate();
  return (
    <label className="one">
      {title}
      <select
        aria-label={label}
        value={value}
        onChange={(event) =>
          void navigate({
            to: ".",
            search: { ...search, [name]: event.target.value },
            replace: true,
            resetScroll: false,
          })
        }
      >
        {options.map((option) => (
          <option key={option.value} value={option.value}>
            {option.text}
          </option>
        ))}
      </select>
    </label>
  );
}
