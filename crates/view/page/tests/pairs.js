// How many times as much one thing takes as another, on a machine on which the same thing takes now more, now less.

/** Standard errors on either side: of Student's t, 96 % lie within by eight pairs, 91 % by four. */
const STANDARD_ERRORS = 2.5;

/**
 * From two pairs on, each measured one right after the other: the geometric mean of second / first, and between what bounds it
 * lies.
 * @param {[number, number][]} pairs
 */
export function ratioOfPairs(pairs) {
  const logs = pairs.map(([first, second]) => Math.log(second / first));
  const mean = logs.reduce((sum, log) => sum + log, 0) / logs.length;
  const variance = logs.reduce((sum, log) => sum + (log - mean) ** 2, 0) / (logs.length - 1);
  const error = STANDARD_ERRORS * Math.sqrt(variance / logs.length);
  return { middle: Math.exp(mean), low: Math.exp(mean - error), high: Math.exp(mean + error) };
}
