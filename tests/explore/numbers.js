/* Numbers and fields of the page at given settings. */
const E = window.explore, settings = SETTINGS;
return settings.map((numbers) => {
  const solution = E.tyre.solve(numbers), field = E.modes.field(solution.state(0.6 * E.tyre.end));
  return { early: solution.at(0.03 * E.tyre.end), late: solution.at(0.71 * E.tyre.end), answers: solution.answers(), field: Array.from(field) };
});
