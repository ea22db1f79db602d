"""The answers of a second reader to the situations: the actors that the ego hinders in each.

Written from traces and pictures, without knowing the oracle that judges them; the three of
``standing_egos`` are of kinds that a reader saw it judge wrongly, and the answers of
``queues_in_exits`` are by the author of that rule, before the oracle had it. Sources: the
Vienna Convention on Road Traffic of 1968 (articles 13, 18, 21 and 23); RSS, rule 3 (Shalev-Shwartz,
Shammah, Shashua 2017); a post-encroachment time under 1 s as a serious conflict (Allen, Shin and
Cooper 1978); nuPlan's bound of comfort of 4.05 m/s² for hard braking.
"""

from __future__ import annotations

from typing import NamedTuple


class Answer(NamedTuple):
    """The actors that the ego hinders in a situation.

    Attributes:
        hindered: Ids of the actors; empty if the ego takes no right of way.
        source: Where the answer comes from.
        reason: What the reader saw.
    """

    hindered: tuple[str, ...]
    source: str
    reason: str


ANSWERS: dict[str, Answer] = {
    "all-way-stop-with-opposite-car-straight-on": Answer(
        (),
        "Vienna Convention art. 18",
        "All-way stop; the movements have no conflict and paths do not meet; the other brakes "
        "for its own stop sign.",
    ),
    "background-at-rose-street-first": Answer(
        (),
        "Vienna Convention art. 18",
        "No priority vehicle on eb_station goes straight near the ego's entry; background:24 "
        "turns right before it, background:1 later, background:18 follows from the ego's own "
        "lane.",
    ),
    "background-at-rose-street-second": Answer(
        ("background:7",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns right into the way of background:7 (M), which brakes 4.5 m/s² at 21 m "
        "from about 11.5 to 6.8 m/s as the ego enters; unbraked it would have arrived at about "
        "9.25 s with the ego in the area (8.30-9.60 s). background:4 passes in the other lane "
        "without braking.",
    ),
    "background-at-the-church": Answer(
        ("background:31",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left from the minor road across/into the way of background:31 (M), which "
        "brakes 9 m/s² to a standstill 3 m from the shared area; it would have arrived at about "
        "8 s. The car behind the ego shares its approach.",
    ),
    "background-at-the-farm": Answer(
        ("background:28",),
        "Vienna Convention art. 18; Allen et al. 1978",
        "Ego turns left into the way of background:28 (right turn, priority), which brakes 8.1 "
        "m/s² to 3.5 m/s, well beyond what its turn (7.6 m/s) needs, and enters the common area "
        "0.75 s after the ego. background:31 brakes behind background:28 and for its own turn.",
    ),
    "background-at-the-harbour-first": Answer(
        (),
        "Vienna Convention art. 18",
        "No priority vehicle is near when the ego turns (7.1-11.6 s): background:14 brakes from "
        "13.1 s for oncoming background:5 and its own left turn, background:5 after it has "
        "passed the ego, the rest far off or for their own bends.",
    ),
    "background-at-the-harbour-second": Answer(
        ("background:24",),
        "Vienna Convention art. 18; RSS rule 3",
        "Ego turns left across straight-going background:24, which would have been there about "
        "7.9 s, half a second before the ego's area time (8.45-10.1 s), and makes an emergency "
        "stop with 9.0 m/s². background:8 slows (3.4 m/s²) behind it, background:13 gently (1.5 "
        "m/s²).",
    ),
    "background-at-the-roundabout": Answer(
        (),
        "Vienna Convention art. 18",
        "No vehicle is in the ring before the entry when the ego enters (background:52 is over "
        "33 m off and reaches it seconds later); the others' braking is for their own entries "
        "and bends.",
    ),
    "background-at-the-town-wall": Answer(
        ("background:13",),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "background:13 (left turn from the main road) has precedence, would have been in the "
        "area about 7.0 s while the ego is there (6.65-8.3 s) and has to stop with 4.5 m/s²; "
        "background:16 was already clear. background:39 brakes behind the stopped "
        "background:13, 16 was before the ego, 3 follows it.",
    ),
    "circulates-while-entering-car-brakes-hard": Answer(
        (),
        "Vienna Convention art. 18",
        "The ego is in the ring (state M); the entering vehicle must give way to it and does. "
        "No one was in the ring when the ego entered.",
    ),
    "comes-out-before-walker-without-signal": Answer(
        (),
        "Vienna Convention art. 21",
        "By SUMO's table this crossing gives way to the ego, so the walker has no right of way "
        "over it here.",
    ),
    "crosses-on-green-while-car-runs-its-red-and-brakes": Answer(
        (),
        "Vienna Convention art. 23",
        "Ego has green (G), the crossing vehicle red: no right of way.",
    ),
    "crosses-on-green-while-crossing-car-brakes-at-red": Answer(
        (),
        "Vienna Convention art. 23",
        "The other is on red and stops for its own signal, the ego has green.",
    ),
    "drives-on-red-and-crossing-car-brakes": Answer(
        ("other",),
        "Vienna Conv. art. 23, 18; nuPlan 4.05 m/s²",
        "Ego runs red across the other's green; the other brakes at 5.1 m/s² from 12 to 4 m/s, "
        "unbraked there at about 7.85 s, 0.35 s after the ego left.",
    ),
    "drives-through-all-way-stop-before-waiting-car": Answer(
        (),
        "Vienna Convention art. 18",
        "All-way stop where each must yield to the other: equal ranks, not judged.",
    ),
    "enters-all-way-stop-while-car-is-turning-in-it": Answer(
        (),
        "Vienna Convention art. 18",
        "All-way stop at which each yields to the other (both letters w): equal ranks, not judged.",
    ),
    "enters-inner-lane-and-inner-car-brakes": Answer(
        (),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "On the entry conflict the ring car brakes only about 3.1 m/s², post-encroachment time "
        "1.75 s; its 3.9 m/s² braking was at 51 m, 6 s before, on another part of the ring, and "
        "it sped up again.",
    ),
    "enters-outer-lane-beside-inner-car": Answer(
        (),
        "Vienna Convention art. 18",
        "The other keeps to the inner ring lane, is no foe of the ego's entry and its path "
        "neither crosses nor merges (over 2.1 m apart); its 3.7 m/s² at 5.85 s is at the ring's "
        "own bend, 22 m away before the ego is in.",
    ),
    "enters-ring-and-circulating-car-brakes-hard": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego enters the ring in front of the ring vehicle with priority; unbraked it would have "
        "been at the merge at about 9.2 s, 0.45 s after the ego; it brakes at 4.9 m/s² from 6.9 "
        "to 2 m/s.",
    ),
    "enters-ring-and-circulating-car-follows-closely": Answer(
        ("other",),
        "Vienna Convention art. 18; Allen et al. 1978",
        "Ego enters the roundabout right in front of the ring vehicle (M): it leaves the merge "
        "point at 8.6 s and the other is there at 8.9 s, 0.30 s later, gap 3.1 m.",
    ),
    "enters-ring-and-circulating-car-touches-it": Answer(
        ("other",),
        "Vienna Convention art. 18; RSS rule 3",
        "The ego enters the roundabout in front of the ring car with priority and they collide.",
    ),
    "enters-ring-well-before-slow-car": Answer(
        (),
        "Vienna Conv. art. 18",
        "Ego enters the ring first, but the ring vehicle does not brake at all and comes 3.05 s "
        "later.",
    ),
    "enters-ring-while-circulating-car-leaves-it": Answer(
        (),
        "Vienna Convention art. 18",
        "The ring car leaves by the exit before the ego's entry; it brakes for its own exit and "
        "their paths do not meet.",
    ),
    "enters-ring-while-circulating-car-stands-in-it": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other had stopped of its own accord at 5.7 s (3.2 m/s²), 2 s before the ego entered, "
        "and stands until 13 s; comes 7.3 s after the ego.",
    ),
    "first-at-all-way-stop-and-later-car-brakes": Answer(
        (),
        "Vienna Conv. art. 18; SUMO table (all-way stop)",
        "All-way stop with mutual giving way; ego stopped and went first, the other brakes for "
        "its own stop sign and comes 4.95 s later.",
    ),
    "from-the-left-and-car-from-the-right-brakes": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego enters before the car from its right (SUMO: ego must yield); that car, which "
        "would have reached the shared area at about 8.7 s as the ego left it (8.70 s), brakes "
        "4.8 m/s² 11 m away, for no other reason.",
    ),
    "from-the-left-while-car-from-the-right-turns-off-behind": Answer(
        (),
        "Vienna Conv. art. 18; SUMO table (right before left)",
        "Movements are no foes and do not cross; the other slows (3.5 m/s²) for its own left turn.",
    ),
    "from-the-right-and-car-from-the-left-brakes": Answer(
        (),
        "Vienna Convention art. 18 (priority to the right)",
        "Ego comes from the right with state M; the other must give way to it and does.",
    ),
    "left-on-green-and-oncoming-brakes-hard": Answer(
        ("other",),
        "Vienna Convention art. 18, 23; nuPlan 4.05 m/s²",
        "Ego turns left on permissive green before the oncoming vehicle with full green; "
        "unbraked this would be there at 8.3 s, 0.6 s after the ego left (7.7 s), and brakes "
        "5.9 m/s² from 13 to 3 m/s.",
    ),
    "left-on-green-before-bus-in-tee-town": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²; art. 23",
        "Ego on minor green (g) turns left in front of the oncoming bus on protected green; the "
        "bus, unbraked there at about 8.3 s (ego in the area 5.65-8.35 s), brakes at up to 4.1 "
        "m/s² from 10 to 1.5 m/s, ending as the ego clears.",
    ),
    "left-on-green-while-oncoming-brakes-at-yellow": Answer(
        (),
        "Vienna Convention art. 18, 23",
        "The oncoming vehicle is 57-69 m away and brakes (3.9 m/s²) for its own yellow and red "
        "signal; at its speed it would have come 3.6 s after the ego left.",
    ),
    "left-on-its-own-green-while-oncoming-brakes-at-red": Answer(
        (),
        "Vienna Conv. art. 23",
        "Other has red throughout and brakes for its own signal; the ego has protected green.",
    ),
    "left-turn-across-two-lanes-stops-both": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left before the oncoming traffic; 'other' brakes 5.0 m/s² from 16 to 6 "
        "m/s and unbraked would have arrived about 0.75 s after the ego left. 'inner' would "
        "have arrived about 1.9 s after it left its lane.",
    ),
    "left-turn-and-oncoming-brakes-after-it": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other begins braking at 10.15 s, 3.3 s after the ego left the shared area (6.85 s), "
        "and unbraked would have come at about 13.7 s: not because of the ego.",
    ),
    "left-turn-and-oncoming-brakes-hard": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left before the oncoming priority car, which brakes 6.5 m/s² from 12 to "
        "3 m/s; unbraked it would have arrived at about 8.2 s, 0.2 s after the ego left.",
    ),
    "left-turn-and-oncoming-brakes-moderately": Answer(
        (),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left before the oncoming car with priority, but that car brakes only at "
        "2.9 m/s² and arrives 1.35 s after the ego left.",
    ),
    "left-turn-and-oncoming-leader-turns-right": Answer(
        (),
        "Vienna Conv. art. 18",
        "The leader (right turn) passes before the ego; the other brakes from 80 m away behind "
        "the slowing leader, before the ego has entered the junction, and comes 3.95 s after "
        "the ego.",
    ),
    "left-turn-and-oncoming-passes-four-seconds-later": Answer(
        (),
        "Vienna Convention art. 18; Allen et al. 1978",
        "Ego turns left before the priority vehicle, which never brakes before the conflict "
        "area (0.7 m/s² only after it) and arrives 3.95 s after the ego has left.",
    ),
    "left-turn-and-oncoming-passes-half-a-second-later": Answer(
        ("other",),
        "Vienna Conv. art. 18; PET < 1 s (Allen et al. 1978)",
        "Ego turns left across the oncoming straight-through traffic (M) to which it must give "
        "way; it leaves the shared area at 7.85 s, the other is there at 8.45 s at 14 m/s: 0.60 "
        "s.",
    ),
    "left-turn-and-oncoming-swerves": Answer(
        ("other",),
        "Vienna Conv. art. 18; PET < 1 s (Allen et al. 1978)",
        "Ego turns left across the oncoming through vehicle with priority; leaves the shared "
        "area 0.15 s before it at a gap of 0.4 m.",
    ),
    "left-turn-and-oncoming-turns-right-after-it": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other slows at most 3.6 m/s² for its own right turn (limit 7.6 m/s, drives it at 5 "
        "m/s) and comes 4.3 s after the ego; unbraked it would have come 2 s after.",
    ),
    "left-turn-before-oncoming-truck": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "Ego turns left across the oncoming lorry with priority; unbraked this would be there "
        "at 8.4 s, 0.15 s after the ego (8.25 s), and brakes 4.4-5.0 m/s² from 13 to 1 m/s.",
    ),
    "left-turn-before-walker-without-signal": Answer(
        ("other",),
        "Vienna Convention art. 21; Allen, Shin and Cooper 1978 (PET < 1 s)",
        "The ego turns left over a marked crossing on which the walker goes first, who was on "
        "it 2.2 s before; the walker nearly stops and reaches the ego's strip 0.50 s after the "
        "ego.",
    ),
    "left-turn-close-before-oncoming-that-turns-right": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left into the exit before the oncoming right-turner with priority, which "
        "brakes 4.2 m/s² from 7 to 0.6 m/s within 6 m; unbraked it would have arrived at 7.8 s "
        "with the ego in the area (6.15-7.90 s).",
    ),
    "left-turn-opposite-left-turn": Answer(
        (),
        "Vienna Conv. art. 18; SUMO table",
        "The two opposing left turns have no conflict (no foes, strips 4 m apart); the other "
        "slows for its own turn.",
    ),
    "left-turn-stops-across-oncoming-lane": Answer(
        (),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego blocks the oncoming car's lane behind a standing vehicle, but the car stops 18 "
        "m short with at most 3.8 m/s² and is not touched.",
    ),
    "left-turn-waits-for-two-oncoming": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego waits and lets both oncoming vehicles pass first; they never brake.",
    ),
    "left-turn-with-oncoming-far-and-standing-car": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other brakes (5.5 m/s²) for the standing leader and stops behind it, 72 m before the "
        "shared area.",
    ),
    "left-turn-with-oncoming-in-the-lane-behind-a-truck": Answer(
        (),
        "Vienna Convention art. 18",
        "The fire engine passed before the ego; the second car never brakes and arrives 3.25 s "
        "later.",
    ),
    "nose-in-the-lane-stops-car": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego enters from the minor road and stops across the major lane (5.4 to 16.35 s); the "
        "other with priority (M), which would have come at about 9.3 s, must brake because of "
        "it at up to 4.3 m/s² and wait.",
    ),
    "one-walker-leaves-and-one-halts": Answer(
        (),
        "Vienna Convention art. 21; Allen et al. 1978",
        "The crossing gives way to the ego by SUMO's table; 'first' crosses before it, 'second' "
        "waits in the middle and enters the strip 1.15 s after the ego.",
    ),
    "out-left-and-car-arrives-four-seconds-later": Answer(
        (),
        "Vienna Convention art. 18; Allen, Shin and Cooper 1978 (PET < 1 s)",
        "No braking and post-encroachment time 3.75 s: the priority car is not affected.",
    ),
    "out-left-and-car-arrives-half-a-second-later": Answer(
        ("other",),
        "Vienna Convention art. 18; Allen, Shin and Cooper 1978 (PET < 1 s)",
        "The ego crosses before the priority car, which passes the same place 0.45 s after it "
        "with 0.9 m gap.",
    ),
    "out-left-and-car-arrives-two-seconds-later": Answer(
        (),
        "Vienna Convention art. 18",
        "The priority vehicle brakes at most 1.5 m/s² before the conflict area and comes 2.0 s "
        "after the ego; 2.9 m/s² only afterwards in its own bend.",
    ),
    "out-left-and-car-brakes-after-ego-has-gone": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego is out of the conflict area at 5.95 s, the other would be there seconds later; it "
        "brakes from 10.7 s only after it has already passed the ego.",
    ),
    "out-left-and-car-brakes-hard": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "Ego turns left across the straight-going priority vehicle; unbraked this would be "
        "there at 8.2 s, 0.1 s after the ego (8.1 s), and brakes 6.0 m/s² from 12 to 2 m/s.",
    ),
    "out-left-and-car-brakes-moderately": Answer(
        (),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The priority car brakes moderately (3.2 m/s²) and arrives 2.05 s after the ego left.",
    ),
    "out-left-and-car-has-braked-long-before": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other stops 57 m before the shared area of its own accord before the ego arrives and "
        "stands until 14 s; not hindered.",
    ),
    "out-left-and-car-swerves-round": Answer(
        ("other",),
        "Vienna Conv. art. 18; PET < 1 s (Allen et al. 1978)",
        "Ego drives past the stop sign without stopping, across the straight major traffic; it "
        "leaves the shared area at 7.45 s and the other is there at 8.35 s at 13 m/s, 0.90 s "
        "later.",
    ),
    "out-left-and-car-touches-tail": Answer(
        ("other",),
        "Vienna Conv. art. 18",
        "Ego crosses the major road from the minor one in front of the through vehicle with "
        "priority; it brakes at 4 m/s² and they collide at 7.95 s.",
    ),
    "out-left-and-truck-arrives-a-second-later": Answer(
        (),
        "Vienna Convention art. 18; Allen, Shin and Cooper 1978 (PET < 1 s)",
        "The lorry with priority does not brake and arrives 1.05 s after the ego left.",
    ),
    "out-left-before-motorcycle-that-brakes": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left into the way of the priority motorcycle, which brakes 4.5 m/s² (4.7 "
        "momentary) from 10 to 1.5 m/s; unbraked it would have arrived at about 8.4 s, 0.5 s "
        "after the slow ego (7.90 s).",
    ),
    "out-left-while-car-creeps-on-the-main-road": Answer(
        (),
        "Vienna Convention art. 18",
        "The priority vehicle creeps at 1.5 m/s, never brakes and never reaches the shared area "
        "in the record; the ego is long gone.",
    ),
    "out-left-while-car-stands-on-the-main-road": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other stands 24 m before the junction for the whole record.",
    ),
    "out-right-and-two-cars-far-behind": Answer(
        (),
        "Vienna Convention art. 18",
        "The other brakes 70 m away behind the slow leader (7 m/s); the leader itself never "
        "brakes and comes 6.5 s after the ego.",
    ),
    "out-right-before-car-from-ramp-speed": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego leaves the stop-signed ramp at 5 m/s into the way of a priority car at 19 m/s, "
        "which brakes up to 4.1 m/s² down to 8 m/s; unbraked it would have run into the ego on "
        "the merged lane around 10.2 s.",
    ),
    "out-right-close-before-fast-car": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego turns right from the minor road into the lane of the through vehicle, which brakes "
        "at 5.6 m/s² from 16 to 6 m/s; unbraked it would have been at the merge at about 8.6 s, "
        "1 s after the ego and much faster than it.",
    ),
    "out-right-while-car-in-the-other-lane-brakes": Answer(
        (),
        "Vienna Convention art. 18",
        "The ego turns into the outer lane, the other goes straight in the inner lane; the "
        "strips stay 1.6 m apart and share no area, so the ego is not in its way.",
    ),
    "out-right-while-car-turns-in": Answer(
        (),
        "Vienna Convention art. 18",
        "The other turns right into the side road: no foe, paths do not meet; it brakes 3.8 "
        "m/s² for its own turn.",
    ),
    "out-right-with-fast-car-far-behind": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other slows gently (1.2 m/s²) 88 m away and comes 7.1 s after the ego.",
    ),
    "passes-straight-while-oncoming-left-turner-brakes": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego goes straight with priority; the oncoming left-turner must give way and does so.",
    ),
    "passes-two-entries-before-two-cars": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "Ego enters the roundabout in front of the ring vehicle; unbraked this would be at the "
        "merge about 8.65 s, 0.4 s after the ego (8.25 s), and brakes 4.6 m/s² down to 2 m/s "
        "only 7-10 m from the ego, with nothing else ahead. 'entering' must give way to the "
        "ego.",
    ),
    "passes-well-before-walker-far-on-the-crossing": Answer(
        (),
        "Vienna Convention art. 21, 23",
        "The walker steps on at 8.25 s on red, 10 m from the ego's strip, and never enters it.",
    ),
    "right-on-green-while-oncoming-left-turner-waits": Answer(
        (),
        "Vienna Convention art. 18, 23",
        "The oncoming left-turner must give way to the right-turning ego; its 4.0 m/s² is its "
        "own yielding.",
    ),
    "right-on-red-before-car-on-green": Answer(
        ("other",),
        "Vienna Convention art. 18, 23; nuPlan 4.05 m/s²",
        "Ego turns right on red into the lane of the vehicle with green; unbraked this would be "
        "at the merge at 8.2 s, 0.55 s after the ego (7.65 s), and brakes 4.5 m/s² from 12 to "
        "4.5 m/s.",
    ),
    "right-turn-after-walker-has-left-the-lane": Answer(
        (),
        "Vienna Conv. art. 21",
        "Walker has green and goes first: out of the ego's strip 2.55 s before the ego gets there.",
    ),
    "right-turn-at-all-way-stop-beside-right-turning-car": Answer(
        (),
        "Vienna Convention art. 18",
        "All-way stop, the two right turns have no conflict; each brakes for its own stop sign.",
    ),
    "right-turn-before-walker-on-green": Answer(
        ("other",),
        "Vienna Convention art. 21(2) (turning drivers); Allen, Shin and Cooper 1978 (PET < 1 s)",
        "The walker has green and goes first by SUMO; the right-turning ego passes 0.1 m in "
        "front of the walker, who must nearly stop and is in the ego's strip while the ego is "
        "still on it.",
    ),
    "same-car-brakes-at-two-parts-of-the-ring": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego enters the ring in front of the ring vehicle with priority; unbraked that one "
        "would have been at the merge at about 9.1 s, 0.4 s after the ego and faster; it brakes "
        "at up to 4.2 m/s² from 6.9 to 3 m/s.",
    ),
    "second-at-all-way-stop-goes-first": Answer(
        (),
        "Vienna Conv. art. 18; SUMO table (all-way stop)",
        "All-way stop with mutual giving way; both had stopped and set off nearly together; "
        "equal ranks, not judged.",
    ),
    "stands-across-the-ring-behind-a-queue": Answer(
        (),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "Ego enters before the ring vehicle and stands behind the standing leader; the other "
        "brakes 3.8 m/s² to a stop 10 m behind it, below hard braking, and the leader blocks "
        "the ring anyway.",
    ),
    "stands-in-the-box-when-cross-street-has-green": Answer(
        (),
        "Vienna Conv. art. 23; art. 18",
        "Ego entered on protected green while the other was on red and the other must give way "
        "by the table; the other stops 12 m away at 3.8 m/s² at most, below hard braking, never "
        "near contact.",
    ),
    "stops-for-walker-and-goes-on": Answer(
        (),
        "Vienna Convention art. 21",
        "The ego stands until the walker has passed; the walker went first by 3.30 s.",
    ),
    "straight-on-before-car-from-the-right": Answer(
        ("other",),
        "Vienna Convention art. 18 (priority by SUMO's table at right-before-left); nuPlan 4.05 "
        "m/s²",
        "Ego bends left across the vehicle that has precedence (M); unbraked this would be "
        "there at 8.9 s as the ego leaves (8.95 s), and brakes 4.2 m/s² nearly to a stop 7 m "
        "before it.",
    ),
    "straight-on-green-while-oncoming-left-turner-brakes": Answer(
        (),
        "Vienna Convention art. 23",
        "The ego has protected green (G); the oncoming left turner has only g and must give way.",
    ),
    "straight-on-long-before-car-from-the-right": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other has the right of way but does not brake and comes 4.0 s after the ego.",
    ),
    "sumo-and-ego-at-all-way-stop": Answer(
        (),
        "Vienna Conv. art. 18; SUMO table (all-way stop)",
        "All-way stop: each must give way to the other and has a stop sign; ego stopped first "
        "and went first; equal ranks, not judged.",
    ),
    "sumo-and-standing-car-and-ego-turns-left": Answer(
        (),
        "Vienna Conv. art. 18",
        "The other brakes (3.2 m/s²) 82 m away for the standing leader and stops behind it, "
        "more than 60 m before the shared area.",
    ),
    "sumo-at-the-entry-and-ego-circulates": Answer(
        (),
        "Vienna Convention art. 18",
        "The ego is on the ring with priority; the entering car had to yield to it.",
    ),
    "sumo-at-the-mill-and-ego-turns-left": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other brakes 96 m away for the coming lower speed limit (11.1 m/s) and reaches the "
        "merge 4.25 s after the ego without slowing further.",
    ),
    "sumo-at-the-quarry-and-ego-turns-left": Answer(
        (),
        "Vienna Convention art. 18",
        "The priority car's 4.5 m/s² braking is 82 m away, from 22.5 to 16.9 m/s at a speed- "
        "limit change (22.2 to 16.7 m/s); post-encroachment time 2.65 s.",
    ),
    "sumo-at-the-ridge-and-ego-turns-left": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other brakes 70-90 m away for the lower speed limit (22.5 to 16.9 m/s) and crosses 5.1 "
        "s after the ego.",
    ),
    "sumo-behind-braking-car-and-ego-turns-right": Answer(
        (),
        "Vienna Conv. art. 18",
        "Leader brakes 69 m before the merge and unbraked would have come about 3.5 s after the "
        "ego, which speeds up ahead of it; the other brakes for the leader.",
    ),
    "sumo-changes-lanes-and-ego-comes-out-right": Answer(
        ("other",),
        "Vienna Convention art. 18 (neither brake nor change direction suddenly)",
        "Ego turns right from the minor road into lane 0, where the priority vehicle would have "
        "been about 7.4 s; it brakes 5.3 m/s² (9.0 momentarily) from 5.7 s and swerves into "
        "lane 1 17 m before the ego, with nothing else ahead.",
    ),
    "sumo-circulates-and-ego-enters": Answer(
        (),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ring car brakes at most 2.3 m/s² (0.5 s mean) and arrives 1.40 s after the ego; "
        "afterwards it just follows.",
    ),
    "sumo-from-the-right-at-the-castle": Answer(
        ("other",),
        "Vienna Convention art. 18 (priority to the right); nuPlan 4.05 m/s²",
        "The straight-going vehicle from the right would have been at the merge at 7.9 s while "
        "the ego is there (7.25-8.8 s); it brakes 4.5 m/s² from 8.4 to 5.3 m/s just as the ego "
        "enters, no leader or bend.",
    ),
    "sumo-near-and-ego-comes-out-left": Answer(
        ("other",),
        "Vienna Convention art. 18; RSS rule 3",
        "Ego turns left across the straight-going priority vehicle, which would have reached "
        "the area at 7.2 s while the ego crosses it (7.45-9.1 s) and has to stop with 8.7 m/s².",
    ),
    "sumo-near-and-ego-comes-out-right": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego turns right from the minor road into the lane of the through vehicle; unbraked "
        "that one would have come at about 9.1 s, 0.4 s after the ego left the first common "
        "place and three times as fast; it brakes at 4.5 m/s².",
    ),
    "sumo-near-and-ego-comes-out-slowly": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego pulls out slowly across the priority car, which brakes 4.5 m/s² from 14 to 1.2 "
        "m/s and comes to about 1.2 m; unbraked it would have arrived at 8.6 s with the ego in "
        "the area (7.30-9.40 s).",
    ),
    "sumo-on-minor-road-and-ego-passes": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego goes straight on the priority road; the left-turner from the side road has to give "
        "way and does so.",
    ),
    "sumo-oncoming-and-ego-stands-across": Answer(
        ("other",),
        "Vienna Conv. art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "Ego turns left behind a standing leader and stops across the oncoming lane; the "
        "through vehicle with priority must brake at 4.5 m/s² for about 3 s from 14 m/s to a "
        "stop 3.3 m before the ego.",
    ),
    "sumo-oncoming-and-ego-turns-left": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego turns left in front of the oncoming priority car, which brakes 4.5 m/s² from "
        "14 to 2.8 m/s within 5 m; unbraked it would have arrived at 8.9 s while the ego "
        "occupied the area (7.30-9.15 s).",
    ),
    "sumo-oncoming-at-signals-and-ego-turns-left": Answer(
        (),
        "Vienna Conv. art. 23",
        "Other has red since 2.0 s and stops for it; the ego has protected green.",
    ),
    "sumo-oncoming-turns-right-and-ego-turns-left": Answer(
        (),
        "Vienna Convention art. 18",
        "The other brakes for its own right turn (limit 7.6 m/s) after the ego had left; post- "
        "encroachment time 3.9 s.",
    ),
    "sumo-passes-later-and-ego-turns-left": Answer(
        (),
        "Vienna Conv. art. 18",
        "Other passes 4.75 s after the ego left; its short braking is for its own lower limits.",
    ),
    "sumo-second-of-two-and-ego-turns-left": Answer(
        ("second",),
        "Vienna Convention art. 18; nuPlan 4.05 m/s²",
        "'first' passes before the ego unhindered. 'second' (priority, straight) would have "
        "been there at 10.2 s while the ego is in the area (8.85-10.55 s) and brakes 4.5 m/s² "
        "from 11.1 to 2.1 m/s, coming within 1.2 m; its leader is 28 m ahead at speed.",
    ),
    "sumo-turns-into-the-road-that-ego-leaves": Answer(
        (),
        "Vienna Convention art. 18",
        "The other turns right with no conflict with the ego's right turn; it brakes for its "
        "own turn.",
    ),
    "sumo-turns-on-to-the-ramp-and-ego-turns-right": Answer(
        (),
        "Vienna Convention art. 18",
        "The other turns right into the entry ramp: no foe, paths at least 5 m apart; it brakes "
        "4.5 m/s² for its own bend (9.5 m/s limit).",
    ),
    "touches-walker-on-crossing": Answer(
        (),
        "Vienna Conv. art. 21; SUMO request table",
        "The ego hits the walker, but by SUMO's table the crossing gives way to the ego and the "
        "ego not to it: walkers do not go first there and have no green, so no right of way was "
        "taken (it is a collision, not a failure to yield).",
    ),
    "two-circulating-cars-and-ego-enters-between": Answer(
        ("second",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The second ring car (priority) brakes 4.6 m/s² 8 m from the entering ego; unbraked it "
        "would have arrived about 0.45 s after the ego left (9.35 s). The first went before the "
        "ego.",
    ),
    "two-sumo-cars-and-ego-turns-right": Answer(
        (),
        "Vienna Convention art. 18",
        "The leader brakes for its own right turn and does not meet the ego's path; the other "
        "brakes (3.5) behind the leader 59 m away and passes in another lane with no shared "
        "area.",
    ),
    "waits-at-the-entry-for-circulating-car": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego stops at the entry and lets the ring vehicle pass first; that one never brakes "
        "(2.3 s between).",
    ),
    "waits-in-the-mouth-and-lets-car-pass": Answer(
        (),
        "Vienna Convention art. 18",
        "Ego stops in the junction and lets the priority vehicle pass first without any braking "
        "(gap 0.7 m beside it, no touch), then goes 1.45 s later.",
    ),
    "walker-halts-away-from-crossings": Answer(
        (),
        "Vienna Convention art. 21",
        "The walker crosses mid-block where there is no marked crossing, so has no right of way.",
    ),
    "walker-in-mid-crossing-halts-before-ego": Answer(
        (),
        "Vienna Conv. art. 21; SUMO request table",
        "The crossing gives way to the ego by SUMO's table (no signal); the walker lets the ego "
        "pass, as it must, and steps into its strip 0.05 s after it: no right of way taken.",
    ),
    "walker-on-crossing-halts-before-ego": Answer(
        (),
        "Vienna Convention art. 21",
        "By SUMO's table the crossing gives way to the ego on the main road; the walker has no "
        "right of way and slows beside the strip.",
    ),
    "walker-on-crossing-steps-back": Answer(
        (),
        "Vienna Conv. art. 21; SUMO request table",
        "Walker steps on for half a second and goes back before the ego arrives, never in its "
        "strip; the crossing gives way to the ego.",
    ),
    "walker-on-green-of-the-other-arm": Answer(
        (),
        "Vienna Convention art. 21",
        "The walker is on a crossing that the ego's path does not touch, 5 m beside its strip.",
    ),
    "walker-on-red-halts-in-the-middle": Answer(
        (),
        "Vienna Convention art. 21, 23",
        "The walker walks against red for the whole time (letter r) while the ego has green, so "
        "it has no right of way, although the ego passes 0.25 s before it.",
    ),
    "walker-passes-along-the-sidewalk": Answer(
        (),
        "Vienna Conv. art. 21",
        "Walker walks along and stops beside the crossing, never on it.",
    ),
    "walker-runs-off-before-ego": Answer(
        (),
        "Vienna Convention art. 21",
        "SUMO makes this crossing give way to the ego, and the walker is first: it leaves the "
        "ego's strip at 5.6 s just as the ego arrives, without a touch.",
    ),
    "walker-steps-on-after-ego": Answer(
        (),
        "Vienna Convention art. 21",
        "The walker steps on at 8.5 s, after the ego is gone; 2.3 s between, and the crossing "
        "gives way to the ego.",
    ),
    "walker-waits-at-the-kerb": Answer(
        (),
        "Vienna Conv. art. 21",
        "Walker stands beside the crossing and never steps on; the crossing gives way to the "
        "ego anyway.",
    ),
    "walker-walks-away-from-egos-lane": Answer(
        (),
        "Vienna Convention art. 21",
        "SUMO gives the ego priority over this crossing, and the walker crossed before the ego "
        "(0.90 s earlier) without being hindered.",
    ),
    "left-turn-waits-with-a-corner-in-the-oncoming-lane": Answer(
        ("other",),
        "Vienna Convention art. 16 and 18; nuPlan comfort bound 4.05 m/s²",
        "The ego stands from 6.6 s on with its front 0.2 m in the way of the oncoming car, which "
        "brakes 4.6 m/s² to a stop, waits, and lets the ego go first.",
    ),
    "left-turn-stands-in-the-exit-for-a-quarter-of-a-minute": Answer(
        (),
        "Vienna Convention art. 18.5 and 18.6",
        "The ego has stood with its tail at the junction for 13 s when the other begins to brake, "
        "which was 100 m and more away when the ego came there: it blocks the way, and did not go "
        "first.",
    ),
    "left-turn-and-oncoming-slows-early-for-its-right-turn": Answer(
        (),
        "Vienna Convention art. 18",
        "The other turns right; it slows to the speed of its turn and keeps it, and reaches the "
        "common area 2.6 s after the ego. Its braking is that of the turn, some metres early.",
    ),
    "left-turn-last-of-a-standing-queue-and-oncoming-turns-right": Answer(
        (),
        "Vienna Convention art. 13.5 and 18.3",
        "The ego has stood out of the junction since 8.6 s, 7.5 m behind the standing leader, when "
        "the other begins to brake 34 m away; the exit has no room for one more vehicle, with or "
        "without the ego it had to come down from 11 m/s to a stop for the queue.",
    ),
    "left-turn-last-of-a-standing-queue-far-out-and-oncoming-turns-right": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The ego is three lengths out of the junction and closing up to the standing leader when "
        "the other begins to brake, 30 m away. It slows for its turn and comes to a stop 26 m "
        "behind the ego, as it would behind the leader.",
    ),
    "left-turn-last-of-a-creeping-queue-and-oncoming-turns-right": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The leader creeps at 2 m/s all the time, and the ego follows it at this speed, out of the "
        "junction, from 8.7 s on. The other, 35 m away, comes down from 11 m/s to the speed of the "
        "queue, as it must for the leader, 11 m further on.",
    ),
    "out-right-last-of-a-creeping-queue-and-car-comes-straight-on": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The queue on the main road creeps at 1.5 m/s. The ego comes out behind it 58 m ahead of "
        "the other, and creeps at its end when that begins to brake 49 m away: for the queue, "
        "which is 8.5 m longer by the ego.",
    ),
    "enters-ring-last-of-a-standing-queue-and-circulating-car-stops": Answer(
        (),
        "Vienna Convention art. 13.5 and 18.3",
        "The ego stands behind the queue from 8.5 s on, past the entry; the other begins to brake "
        "at 9 s, 28 m behind it on the ring, from 7.5 m/s, and stops before the entry. It could "
        "have driven on for one length, no further.",
    ),
    "left-turn-last-of-a-standing-queue-and-sumo-turns-right": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The other brakes 4.5 m/s² from 14 to 8 m/s for its right turn, 24 m and more from the "
        "ego, which is two lengths out of the junction behind the standing leader; then it rolls "
        "up to the queue by 2.7 m/s² and less.",
    ),
    "left-turn-into-a-free-exit-close-before-oncoming-that-turns-right": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego is in the exit of the other's right turn from 6 to 9.5 s; the other would have "
        "been there at 9.3 s at 8 m/s and brakes 4.6 m/s² to 0.8 m/s, 10 m from the ego. The next "
        "vehicle in the exit is 42 m ahead of the ego and drives on at 7 m/s.",
    ),
    "out-right-behind-a-flowing-leader-close-before-car": Answer(
        ("other",),
        "Vienna Convention art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "The leader passes at 13 m/s, about as fast as the other (14 m/s), which has no need to "
        "brake for it. The ego comes out between them at 5 m/s, 26 m ahead of the other, which "
        "brakes 5.4 m/s² down to 6 m/s.",
    ),
    "left-turn-close-before-oncoming-and-queue-far-in-the-exit": Answer(
        ("other",),
        "Vienna Convention art. 18; nuPlan comfort bound 4.05 m/s²",
        "The ego is in the junction at 3.5 m/s, 14 m from the other, which brakes 4.6 m/s² from 8 "
        "to 1 m/s. The queue stands 40 m and more behind the place where it brakes, and asks for "
        "less than 1 m/s² there.",
    ),
    "left-turn-stands-in-the-junction-behind-a-queue-and-oncoming-stops": Answer(
        ("other",),
        "Vienna Convention art. 18 and 18.3; nuPlan comfort bound 4.05 m/s²",
        "The ego enters although its exit is full, and stands across the oncoming lane from 8.6 s "
        "on; the other, which goes straight on and not into the exit, brakes 4.6 m/s² from 12 m/s "
        "to a stop.",
    ),
    "out-right-into-the-last-place-of-a-queue-right-before-car": Answer(
        ("other",),
        "Vienna Convention art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "The ego comes out at 5 m/s 14 m (centre to centre) ahead of the other's 11 m/s, and stops "
        "there behind the queue. The other brakes by 5.7 m/s² and stops 1 m behind it; 3.5 m/s² "
        "were enough for the queue without the ego.",
    ),
    "enters-ring-close-before-circulating-car-and-queue-far-on": Answer(
        ("other",),
        "Vienna Convention art. 18; RSS rule 3; nuPlan 4.05 m/s²",
        "The ego enters 12 m before the circulating car, which brakes 4.8 m/s² from 7 to 2 m/s; "
        "the queue in the exit is 45 m further on and asks for nothing yet.",
    ),
    "left-turn-closes-up-to-a-queue-and-oncoming-turns-right-and-follows": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The ego leaves the junction behind a leader that has stood 7 m ahead of its front and "
        "moves on; 4.4 m/s² of the other, 23 m away, are more than the ego asks for (2.5 m/s²) and "
        "as early as for the queue: it comes down to the speed of the queue and follows.",
    ),
    "left-turn-closes-up-to-a-queue-and-oncoming-stops-at-its-line": Answer(
        (),
        "Vienna Convention art. 13.5 and 18.3",
        "The ego is out of the junction and closes the last 2 m to the standing leader when the "
        "other begins to brake, 34 m away, from 12.9 m/s to a stop at its line. Without the ego it "
        "had to stop for the leader 7 m further on.",
    ),
    "left-turn-closes-up-to-a-queue-and-oncoming-turns-right-early-slow": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The ego is out of the junction behind the standing leader; the other brakes from 11 to 4 "
        "m/s 21 to 30 m before it, and rolls up to it through its turn, as to any queue.",
    ),
    "out-right-closes-up-to-a-creeping-queue-and-car-comes-straight-on": Answer(
        (),
        "Vienna Convention art. 13.5 and 18",
        "The ego creeps at 1.5 m/s, as fast as the leader 8.5 m ahead of it, when the other begins "
        "to brake 26 m away; it had to come down from 11.5 to 1.5 m/s for the leader as well, and "
        "stays 15 m behind the ego.",
    ),
    "enters-ring-and-closes-up-to-a-queue-and-circulating-car-stops": Answer(
        (),
        "Vienna Convention art. 13.5 and 18.3",
        "The ego closes the last metre to the standing leader when the circulating car begins to "
        "brake, 20 m behind it, and stops 14 m behind it: for the queue, which the ego makes one "
        "place longer.",
    ),
}
"""By the names of the situations."""
