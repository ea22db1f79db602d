/** The screens in the order of the top line; `g` and the key go there. */
export const SECTIONS = [
  { to: "/campaigns", name: "Campaigns", key: "c" },
  { to: "/studies", name: "Studies", key: "s" },
  { to: "/runs", name: "Runs", key: "r" },
  { to: "/failures", name: "Failures", key: "f" },
  { to: "/suites", name: "Suites", key: "u" },
  { to: "/batches", name: "Batches", key: "b" },
  { to: "/author", name: "Author", key: "d" },
  { to: "/networks", name: "Networks", key: "n" },
  { to: "/agents", name: "Agents", key: "a" },
  { to: "/workers", name: "Workers", key: "w" },
] as const;
