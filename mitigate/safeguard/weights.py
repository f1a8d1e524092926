"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -0.400,
    "orders": 0.471,
    "text": 0.701,
    "annul": 0.363,
    "invert": 0.014,
    "case": 0.510,
    "halt": 0.379,
    "machine": 0.339,
    "role": 0.286,
    "authority": 0.555,
    "haste": -0.069,
    "if": 0.037,
    "me": -0.517,
    "you": -0.005,
    "third": 0.156,
    "past": 0.042,
    "not": -0.047,
    "here": 0.040,
    "time": 0.135,
    "go": 0.134,
    "has orders": 0.400,
    "has text": 0.173,
    "has annul": 0.392,
    "has invert": 0.177,
    "has case": 1.155,
    "has halt": 0.003,
    "has machine": 0.291,
    "has role": 0.317,
    "has authority": 0.533,
    "has haste": -0.065,
    "has if": 0.254,
    "has me": -0.044,
    "has you": -0.313,
    "has third": 0.094,
    "has past": 0.253,
    "has not": -0.022,
    "has here": -0.350,
    "has time": 0.151,
    "has go": 0.497,
    "hidden": 3.036,
    "alike": 2.600,
    "wide": 2.981,
    "spelled": 2.215,
    "leet": 2.240,
    "code": 1.393,
    "cipher": 1.856,
    "unknown": 0.385,
    "alien": 0.128,
    "foreign letters": 0.394,
    "late verb": 0.097,
    "no verb": 0.200,
    "on route": -0.086,
    "other things": 0.149,
    "nothing": 0.162,
    "turns": 0.026,
    "places": -0.080,
    "no place": 0.701,
    "length": 0.415,
    "short": -0.657,
    "commas": -0.706,
    "asks": -0.098,
    "exclaims": 0.058,
    "quoted": 1.245,
    "quote in": -0.205,
    "markup": 2.710,
    "role of": -0.169,
    "reported": 0.127,
    "self": 0.299,
    "about": 1.087,
    "back to text": -0.457,
    "elsewhere": 0.021,
    "annul orders": 0.216,
    "invert orders": 0.868,
    "case orders": -0.067,
    "not orders": 0.012,
    "halt nowhere": -0.356,
    "halt here": 0.335,
    "not go": -0.025,
    "both sides": 0.765,
    "case not": -0.222,
    "case go": 0.508,
    "case halt": 0.187,
    "me past": 0.203,
    "third past": -0.201,
    "you role": 0.110,
    "authority said": 0.307,
    "machine you": 0.406,
    "me no place": 0.153,
    "past no you": 0.059,
    "annul place": 0.024,
    "not place": 0.440,
    "if place": -0.483,
    "words": 0.919,
    "pairs": 0.601,
    "worst words": -0.000,
    "best words": 0.694,
}
CONTEXT: dict[str, float] = {
    "bias": 0.625,
    "own": 0.887,
    "first": -0.788,
    "last": -0.039,
    "stops early": 1.257,
    "stops before all": 0.326,
    "denies the rest": -0.466,
    "repeats the rest": -0.283,
    "neighbour": 1.096,
    "neighbours": 1.613,
    "alone": -1.299,
    "most": -1.582,
}
PART: dict[str, float] = {
    "bias": -0.747,
    "whole": -0.006,
    "orders": 0.021,
    "text": 0.239,
    "annul": 0.451,
    "invert": 0.157,
    "case": 0.368,
    "halt": 0.497,
    "machine": 0.430,
    "role": 0.194,
    "authority": 0.729,
    "haste": 0.042,
    "if": -0.207,
    "me": -0.648,
    "you": -0.201,
    "third": 0.046,
    "past": 0.071,
    "not": -0.350,
    "here": -0.027,
    "time": 0.037,
    "go": 0.331,
    "has orders": -0.077,
    "has text": 0.407,
    "has annul": 0.444,
    "has invert": 0.157,
    "has case": 0.487,
    "has halt": 0.304,
    "has machine": 0.430,
    "has role": 0.194,
    "has authority": 0.729,
    "has haste": 0.042,
    "has if": 0.091,
    "has me": -0.526,
    "has you": -0.398,
    "has third": 0.206,
    "has past": 0.069,
    "has not": -0.210,
    "has here": -0.594,
    "has time": 0.060,
    "has go": -0.196,
    "hidden": 1.128,
    "alike": 3.583,
    "wide": 1.933,
    "spelled": 0.697,
    "leet": 3.169,
    "code": 1.608,
    "cipher": 2.423,
    "unknown": 1.014,
    "alien": 0.410,
    "foreign letters": 0.501,
    "late verb": -0.052,
    "no verb": -0.711,
    "on route": 0.162,
    "other things": -0.198,
    "nothing": 0.322,
    "turns": 0.410,
    "places": 0.042,
    "no place": -0.112,
    "length": -0.242,
    "short": -0.325,
    "commas": 1.453,
    "asks": -0.760,
    "exclaims": -0.572,
    "quoted": 0.689,
    "quote in": 2.028,
    "markup": 0.000,
    "role of": -0.108,
    "reported": 0.372,
    "self": -0.172,
    "about": 0.310,
    "back to text": -0.355,
    "elsewhere": 0.961,
    "annul orders": 0.689,
    "invert orders": 0.789,
    "case orders": 0.180,
    "not orders": 0.372,
    "halt nowhere": 0.511,
    "halt here": 0.111,
    "not go": 0.435,
    "both sides": 1.023,
    "case not": 0.123,
    "case go": 0.247,
    "case halt": 0.054,
    "me past": -0.116,
    "third past": 0.166,
    "you role": -0.157,
    "authority said": 0.289,
    "machine you": 0.361,
    "me no place": -0.556,
    "past no you": -0.101,
    "annul place": 0.227,
    "not place": 0.352,
    "if place": -0.047,
    "words": 1.414,
    "pairs": 0.994,
    "worst words": -0.090,
    "best words": -0.566,
}
STYLE = bag(
    """
    advisable appreciated below betake breather briefing bunch closing colleague commence
    complete completion conclude conclusion cooperation course cruise day dear depart do easy
    effect egress esteemed explain finally finish for friend fully fun goes good got greetings
    guess happy have hello help hey hi hiya hm i i'm if initially juncture kind kindly let let's
    like lovely madam may me meet mosey need new nice off okay or outset permission please
    reverse scoot sincere sir strolling subsequently thanks that's thereafter think this transit
    transition try u ultimately um upon vacate want what withdraw would you'll you've yourself
    """
)
_WORDS = bag(
    """
    0=100 07=181 1=-200 10=-142 12=-37 120=-42 13=181 135=-42 14=-42 15=-42 16=-42 18=-42
    180=-164 180_degrees=-164 1_m=-113 2=-200 20=-71 204=-142 214=-71 270=-42 2_m=-198
    2_meters=-113 2_nd=-94 3=-200 30=-94 306=-71 308=-42 310=-42 3_5=-164 3_is=-94 3_m=-94
    3_meters=-113 3_step=-71 4=8 408=-42 45=-71 4_=-128 4_m=-174 4_stop=-142 5=-200 5_m=-113
    5_meters=-113 6=-94 64=181 7=-113 7741=181 8=-42 9=-154 90=-200 90_degrees=-200 9_m=-113
    _=200 _1=-142 _2=-94 _3=-142 _4=-94 _a=113 _action=200 _actually=129 _advance=-128 _after=19
    _all=200 _always=200 _and=-200 _anyway=-113 _as=173 _ascend=-94 _assistant=200 _at=-70
    _back=-198 _bear=-200 _bedroom=-94 _before=61 _begin=-6 _behind=-113 _between=39 _beyond=-94
    _bottom=-113 _bound=-94 _bullet=-94 _but=87 _by=200 _cancel=200 _climb=-200 _come=-200
    _consider=200 _continue=-78 _could=7 _count=-94 _cross=-200 _descend=-148 _disregard=165
    _do=123 _don't=3 _door=-164 _down=-10 _each=197 _end=59 _enter=-200 _every=180
    _everything=166 _exit=-200 _face=-80 _facing=-200 _find=-200 _first=-164 _follow=-116
    _for=200 _forget=124 _from=-13 _front=87 _get=-187 _go=-194 _good=109 _hallway=-94 _halt=99
    _hang=-113 _he=100 _head=17 _heading=-113 _here=-198 _hey=129 _hold=11 _i=150 _i'd=109
    _i'm=-94 _if=117 _ignore=131 _imagine=109 _in=52 _inside=-113 _instead=-200 _into=-113
    _it=124 _it'll=-113 _it's=56 _job=-113 _just=46 _keep=-78 _kindly=200 _ladder=-94 _lap=-94
    _leave=-178 _left=-19 _leg=-142 _let's=-53 _line=-128 _locate=-113 _look=-200 _make=-142
    _message=200 _move=-200 _my=140 _never=200 _new=200 _next=-200 _no=168 _not=-48 _nothing=200
    _notice=200 _now=-200 _objective=-94 _of=-94 _off=-94 _okay=-200 _on=-112 _once=-18
    _one=-154 _only=163 _open=-94 _out=-200 _override=100 _par=-113 _pass=-200 _past=-200
    _perform=200 _phase=-142 _plan=-94 _please=200 _proceed=-200 _quick=-94 _read=200
    _remain=129 _remember=200 _return=129 _reverse=-10 _right=-200 _rotate=-94 _route=-164
    _second=-174 _see=-183 _sharp=-94 _sit=109 _skip=105 _slide=109 _so=-200 _spin=53
    _stage=-113 _stairs=-164 _stand=-61 _start=-200 _starting=-178 _stay=137 _step=-200
    _stop=-167 _straight=-200 _swap=200 _swing=-94 _switch=100 _system=200 _take=-81 _task=200
    _thank=200 _that=125 _that's=-200 _the=143 _then=-200 _there=-1 _there'll=-94 _there's=-200
    _they=115 _thing=-94 _third=-128 _this=200 _three=-128 _through=-128 _to=-17 _train=-94
    _treat=200 _turn=-135 _two=-200 _under=200 _until=200 _up=-200 _use=-183 _user=200
    _veer=-183 _wait=-78 _walk=-200 _we=124 _we'll=-128 _we're=-128 _we've=109 _what=170
    _whatever=200 _when=-53 _whenever=189 _where=96 _with=-67 _without=-191 _x=200 _you=12
    _you'll=-200 _you're=-200 _your=128 a=-49 a_balcony=-83 a_bathroom=-195 a_bathtub=-113
    a_bed=-200 a_bedroom=-113 a_bench=-148 a_big=-200 a_bit=-128 a_black=-159 a_blue=-164
    a_bookcase=-142 a_bookshelf=-94 a_bowl=-113 a_brown=-142 a_bunch=-94 a_cabinet=-71 a_cat=109
    a_chair=15 a_chapel=-94 a_circle=182 a_closed=-94 a_closet=-121 a_comfy=-94 a_couch=27
    a_couple=-198 a_cross=-94 a_curtain=-104 a_cushion=-174 a_desk=-200 a_dining=-104 a_dog=-94
    a_door=50 a_doorway=-142 a_dresser=-83 a_few=2 a_fireplace=-148 a_fish=-135 a_floor=-128
    a_fork=-164 a_friendly=-94 a_gift=-94 a_glass=-195 a_good=87 a_gray=-104 a_green=-164
    a_grey=-58 a_half=-183 a_hall=-128 a_hallway=-89 a_hard=-142 a_hat=-94 a_horse=-154
    a_huge=-94 a_kitchen=-154 a_ladder=-142 a_lamp=-200 a_large=-183 a_laundry=-104 a_left=-157
    a_lion=-113 a_little=-200 a_lobby=-94 a_long=-200 a_lot=-94 a_marble=-94 a_metal=-71
    a_microwave=-94 a_mirror=21 a_narrow=-113 a_nice=-128 a_nursery=-94 a_phone=-94 a_piano=-128
    a_picture=-164 a_pillar=-94 a_pink=-94 a_plant=-198 a_pool=-104 a_popcorn=-113 a_potted=-113
    a_pretty=-94 a_purple=-128 a_quick=-94 a_railing=-113 a_red=-200 a_refrigerator=-113
    a_right=-144 a_road=-94 a_robot=53 a_rocking=-94 a_room=24 a_round=-178 a_row=-142 a_rug=-94
    a_seat=-164 a_set=-121 a_sharp=-200 a_shelf=-121 a_shiny=-113 a_ship=-94 a_short=-94
    a_sign=39 a_sink=-198 a_slight=-200 a_small=-191 a_sofa=-164 a_square=-148 a_staircase=53
    a_stand=-94 a_stone=-142 a_stool=-94 a_stop=-80 a_straight=-94 a_striped=-128 a_sweet=-113
    a_table=-200 a_tall=-113 a_tan=-121 a_tapestry=-71 a_technician=200 a_teeny=-113
    a_television=-178 a_tiny=-128 a_toilet=-142 a_towel=-121 a_trash=-83 a_turn=-128 a_tv=-94
    a_u=-200 a_vase=-94 a_waiting=-94 a_wall=24 a_white=-121 a_whole=-94 a_wicker=-71
    a_window=-200 a_wood=-113 a_wooden=-148 a_yellow=-121 abandon=39 abeam=-42 able=-42
    abort=181 about=164 about_the=200 about_to=200 about_turn=-94 above=200 absolutely=-42
    abutment=-42 access=200 accident=181 accommodation=-42 accomplished=-142 according=181
    accordingly=200 accordingly_=200 accounting=-42 accounts=-42 acquire=-71 across=-200
    across_it=-164 across_the=-200 act=186 acting=200 action=200 action_stop=200 actual=-42
    actually=129 add=139 addressee=181 adjacent=-42 adjustment=-42 admin=181 administrator=200
    administrator's=-142 administrator_has=200 admire=-42 admiring=-42 adn=181 adorable=-42
    advance=-183 advance_to=-154 afford=-42 aft=-94 after=20 after_each=200 after_every=200
    after_it=-198 after_that=-191 after_the=-200 after_this=129 again=-11 again_=84 again_and=68
    again_around=-94 again_at=-200 against=147 against_the=147 agent=181 ago=-42 agree=181
    agreed=181 ahead=-190 ahead_=-200 ahead_and=-164 ahead_of=-200 ahead_to=-113 ahhh=-42
    aid=-142 aim=-42 airlock=-42 aisle=-200 aisle_=-164 aisle_and=-128 aisle_between=-183
    aisle_to=-94 alarm=-198 alcove=-154 alcove_on=-94 alighting=-42 align=-42 all=137 all_=200
    all_around=-142 all_of=134 all_robots=200 all_that=200 all_the=-63 all_turns=200 all_you=109
    alley=-42 allow=200 allow_what=200 allowed=129 almost=-42 along=-139 along_it=-164
    along_that=-94 along_the=-149 along_to=-113 along_until=-94 alongside=-200
    alongside_the=-200 alpha=-71 already=200 already_=200 alright=-42 alrighty=-42 also=-113
    altar=-200 altar_=-113 alter=-42 alters=-42 always=192 always_do=200 always_use=119 am=200
    am_the=200 amble=-42 an=10 an_elevator=-113 an_office=-154 an_open=7 an_orange=-71
    an_oval=-71 an_oven=-71 an_umbrella=-94 ancelledcay=181 anchor=-71 and=-90 and_=174
    and_a=-200 and_after=-183 and_around=-113 and_as=-128 and_at=-200 and_back=170 and_bear=-83
    and_between=-94 and_carry=-191 and_climb=-169 and_come=24 and_continue=-198 and_cross=-164
    and_do=199 and_don't=-191 and_down=-63 and_enter=-200 and_exit=-154 and_face=87
    and_find=-191 and_finish=200 and_follow=-200 and_get=-128 and_give=-94 and_go=-138
    and_halt=-200 and_hang=-187 and_head=-200 and_hold=-142 and_i'll=-94 and_into=-200
    and_it=-142 and_it's=-200 and_just=-128 and_keep=-200 and_leave=43 and_left=-183
    and_look=-174 and_make=-200 and_move=-94 and_no=-128 and_not=87 and_on=-154 and_once=-104
    and_out=-123 and_pass=-200 and_past=-80 and_proceed=-58 and_put=-94 and_report=200
    and_right=186 and_round=53 and_say=-113 and_second=-113 and_stand=72 and_stay=181
    and_step=-178 and_stop=-200 and_straight=-174 and_take=-112 and_that=7 and_that's=-198
    and_the=-110 and_then=-200 and_there=-113 and_there's=-200 and_through=-200 and_to=-94
    and_toward=-200 and_turn=-200 and_two=-154 and_up=-200 and_veer=-113 and_wait=-85
    and_walk=-197 and_when=-200 and_white=-128 and_you=-63 and_you'll=-200 and_you're=-183
    angel=-42 angle=-154 annotator=181 announces=181 another=121 another_door=-94 answer=181
    anticlockwise=-42 any=200 any_further=200 any_more=194 any_of=200 anyhow=-42 anyone=200
    anything=186 anytime=181 anyway=-128 anywhere=200 anywhere_=200 anywho=-42 apart=-42
    apartment=-71 aperture=-71 appearance=-42 appears=181 apples=-113 applies=181 apply=109
    apply_a=109 approach=147 approved=200 approximately=-71 aquarium=-164 arbitrary=-42
    arcade=-71 arch=-200 arch_=-200 arch_and=-198 arched=-94 arches=-42 archive=-71 archway=-200
    archway_=-200 archway_and=-164 archway_on=-94 archway_turn=-71 are=106 are_=200 are_a=200
    are_about=200 are_at=147 are_behind=-113 are_by=-169 are_done=12 are_facing=-200
    are_four=-94 are_given=200 are_in=-112 are_inside=-94 are_no=129 are_not=185 are_now=-200
    are_on=-164 are_out=170 are_some=-94 are_standing=-200 are_the=200 are_there=17 are_told=200
    are_two=-200 are_void=200 area=-200 area_=-164 area_and=-135 area_then=-71 area_with=-148
    aren't=-42 arguments=181 arm=-128 arm's=-71 armchair=-200 armchair_=-200 armchair_and=-94
    armchair_then=-71 armchairs=-142 armchairs_and=-113 armor=-154 armor_=-142 armour=-42
    armrest=-71 arms=-183 arms_=-164 around=-110 around_=-19 around_and=-29 around_go=-104
    around_here=109 around_it=-76 around_its=-94 around_so=-183 around_the=-200 around_then=-71
    around_to=-200 around_until=-174 arr=-42 arrival=-42 arrived=155 arrived_=200 arrow=-94
    art=-128 artwork=-71 as=143 as_a=200 as_far=-200 as_if=152 as_it=100 as_long=200 as_soon=-56
    as_the=123 as_they=109 as_this=200 as_you=-142 as_your=200 ascend=-113 ascended=-42
    ascending=-42 aside=181 ask=147 asked=200 asks=200 asks_that=200 asleep=-42 assistant=200
    assistant_=200 assumed=181 at=-118 at_a=8 at_all=100 at_any=200 at_each=200 at_every=200
    at_it=-164 at_its=-200 at_once=200 at_that=-128 at_the=-200 at_your=77 atm=-94 atrium=-71
    attempt=181 attention=39 attic=-200 attic_=-104 attic_and=-104 attic_through=-58 auntie=-42
    auntie's=-42 authorise=181 authorised=139 authority=181 automatic=-174 automatic_doors=-154
    available=-42 avoid=200 avoided=200 aw=-42 await=139 away=30 away_from=10 awful=-42
    awning=-113 axis=124 axis_=130 axis_at=119 axle=-42 aystay=181 azimuth=-42 b=-37 b_and=-94
    babe=-42 babies=-71 baby=-164 baby's=-42 baby_gate=-113 back=93 back's=-42 back_=200
    back_and=151 back_door=-200 back_from=-15 back_inside=-200 back_into=-142 back_is=109
    back_of=-191 back_on=-174 back_out=-200 back_past=-113 back_stairs=-94 back_through=109
    back_to=143 backpack=-42 backs=-71 backward=200 backward_wherever=119 backwards=170 bag=-94
    baggage=-71 balcony=-200 balcony_=-200 balcony_and=-113 bales=-71 ball=-113 balloon=-71
    ballroom=-183 ballroom_=-94 balls=-113 balls_and=-94 balusters=-42 balustrade=-71 bamboo=-71
    bananas=-128 bananas_=-94 bang=-42 banister=17 bank=-94 banquet=-71 baptismal=-71
    baptistery=-113 bar=-200 bar_=-200 bar_and=-174 bar_area=-164 bar_on=-113 bar_stool=-94
    bar_stools=-200 bar_with=-113 barbecue=-164 barbecue_=-94 barn=-174 barn_door=-113
    barometer=-71 barrel=-183 barrel_table=-113 barrels=-198 barrels_=-94 barrels_and=-154
    barrier=-113 bars=-71 barstool=-42 base=129 basement=53 basically=181 basket=-200
    basket_=-154 basket_and=-113 basketball=-71 baskets=-71 bath=-128 bathrobes=-42
    bathroom=-134 bathroom_=-123 bathroom_and=-200 bathroom_door=-113 bathroom_on=-159
    bathroom_then=-142 bathroom_with=-113 bathtub=-200 bathtub_=-200 bathtub_and=-71 battery=200
    bay=-198 bay_window=-183 be=73 be_a=-200 be_careful=-142 be_done=200 be_facing=-200
    be_in=-200 be_next=-200 be_obeyed=200 be_on=-200 be_the=-94 bead=-94 bead_curtain=-94
    beaded=-94 beaded_curtain=-94 beam=-71 bean=-71 beanbag=-154 beanbags=-71 bear=-125
    bear_=-128 bear_left=-154 bear_right=-200 bear_slightly=-94 bearing=-154 beautiful=-94
    beauty=-71 because=-200 because_the=-128 bed=-200 bed_=-200 bed_and=-200 bed_in=-94
    bed_on=-198 bed_take=-83 bed_to=-113 bed_turn=-71 bed_walk=-94 bed_with=-191 bedding=-42
    bedroom=-54 bedroom_=45 bedroom_and=-200 bedroom_at=-128 bedroom_go=109 bedroom_past=-94
    bedroom_then=-58 bedroom_with=-187 bedrooms=181 beds=-106 beds_=-198 beds_and=-142
    beds_are=109 been=200 been_cancelled=200 beers=-42 before=90 before_=200 before_it=74
    before_the=-36 before_you=143 began=200 began_=200 begin=91 begin_=200 begin_by=-6
    beginning=200 beginning_=200 begins=200 begins_=170 begun=181 behalf=181 behave=181
    behind=-200 behind_it=-191 behind_the=-200 behind_you=-200 beige=-94 being=-94 believe=-42
    bell=-164 bell_=-94 bellhop's=-71 below=200 below_is=200 belt=-94 bench=-200 bench_=-200
    bench_and=-200 bench_in=-104 bench_then=-71 benches=-142 benches_=-128 bend=-42 bends=-113
    beneath=-164 beneath_the=-113 berth=-42 beside=-116 beside_a=-94 beside_it=-142
    beside_the=-200 bestie=-42 bet=-42 better=109 between=-200 between_the=-200
    between_them=-191 between_two=-113 beyond=53 beyond_it=109 bicycle=-164 bicycle_=-113
    bicycles=-71 bidet=-94 bidet_and=-94 bifurcates=-42 big=-200 big_desk=-113 big_glass=-113
    big_window=-94 bigger=-42 biggest=-94 bike=-200 bike_=-121 bike_and=-104 bikes=-142
    bikes_and=-94 billet=-42 billiard=-113 billiard_table=-113 billiards=-71 bin=-113 bin_=-113
    bird=-42 birdbath=-142 birdbath_=-113 birdcage=-71 birds=-42 biscuit=-42 bisect=-42 bit=-53
    bit_left=-94 bit_to=-94 black=-200 black_and=-128 black_door=-113 black_railing=-83
    blackboard=-142 blackboard_=-113 blanket=-142 blanket_=-113 blankie=-42 bleachers=-71
    bless=-42 blocked=68 blocks=181 blood=-71 blue=-200 blue_carpet=-128 blue_chairs=-94
    blue_sofa=-83 blurs=181 board=32 board_=-200 board_with=-113 boardroom=-71 boat=-71 body=-42
    boiler=-191 boiler_=-154 bollard=-71 bones=-42 book=87 bookcase=-200 bookcase_=-187
    bookcase_and=-154 bookcase_then=-71 bookcases=-113 bookcases_=-113 books=-113 bookshelf=-200
    bookshelf_=-195 bookshelf_and=-83 bookshelves=-94 boom=-42 boot=-94 booth=-200 booth_=-128
    booth_and=-142 booths=-94 boots=-128 boots_and=-94 borders=181 boss=151 both=-200
    both_flights=-142 both_sides=-142 bother=181 bottles=-94 bottom=-200 bottom_=-200
    bottom_and=-94 bottom_of=-200 bottom_turn=-154 bottom_you'll=-94 bound=-94 bounds=139
    bouquet=-71 bowl=-183 bowl_=-113 bowl_of=-128 bowling=-42 box=-142 box_=-113 boxes=68
    boxes_=-94 boys=-42 branch=-71 brass=-154 bravo=-42 breach=-42 bread=-113 bread_and=-94
    break=53 break_room=-94 breakfast=-200 breakfast_nook=-200 breaking=-42 breath=-42
    breathe=-42 breather=-42 breathtaking=-42 breeze=-42 brick=-200 brick_steps=-94
    brick_wall=-183 bricked=-42 bricks=-42 bridge=-142 bridge_and=-94 bright=-113
    bright_hallway=-94 bring=-42 brings=-42 brochure=-113 broken=200 brolly=-42 bronze=-42
    broom=-71 brother=139 brother's=-42 brothers=-42 brown=-200 brown_couch=-83 brown_door=-113
    brr=-42 brrr=-42 brushes=-42 bubbles=-42 bubbling=-42 bucket=-154 bucket_=-94 buddha=-71
    buddy=-94 buffer=181 buffet=-142 buffet_=-113 build=181 building=170 building_=200 built=200
    bulb=-71 bulkhead=-42 bullet=-94 bulletin=-113 bulletin_board=-113 bum=-71 bump=-142
    bump_into=-113 bunch=-113 bunch_of=-94 bunk=-200 bunk_=-113 bunk_beds=-200 bunks=-71
    bursting=-42 bushes=-71 bust=-198 bust_=-164 bust_on=-94 but=-89 but_do=109 but_don't=-154
    but_it's=-113 but_not=-154 but_only=-94 but_turn=-113 but_you=-94 butler's=-42 butterfly=-42
    buttons=-42 by=-79 by_=68 by_a=59 by_facing=-178 by_it=-154 by_order=200 by_the=-154
    by_walking=-10 by_way=-195 bypass=-42 c=-183 cabin=-200 cabin_and=-113 cabin_door=-142
    cabinet=-200 cabinet_=-200 cabinet_and=-178 cabinet_with=-113 cabinets=-148 cabinets_=-113
    cabins=-113 cables=-94 cables_=-94 cactus=-183 cactus_=-113 caf=-142 cafe=-174 cafeteria=-42
    cage=-94 cake=-94 cake_=-94 cakes=-42 calibration=181 call=109 call_it=109 called=31
    called_a=-142 calling=181 calories=-42 came=-2 camera=129 can=-69 can't=8 can't_go=7
    can_=-142 can_and=-58 can_go=-142 can_see=-200 can_stop=-63 can_then=-128 cancel=200
    cancel_the=200 cancelled=200 cancelled_=200 cancelled_the=172 candle=-200 candle_holder=-174
    candles=-191 candles_=-113 candles_and=-113 candles_on=-94 candy=-94 cannon=-42 cannons=-42
    cannot=-42 canopy=-113 cans=-71 captain=181 captain's=-42 car=-183 car_and=-128 card=-71
    careful=-200 carefully=-42 caretaker=181 carousel=-71 carpet=-200 carpet's=-42 carpet_=-200
    carpet_and=-104 carpet_on=-71 carpet_to=-159 carpeted=-128 carpets=-42 carriage=-42
    carried=200 carry=100 carry_on=-37 carry_out=200 carrying=-71 cars=-71 cart=-142 carts=-154
    carts_=-113 case=-72 case_=-178 case_on=-113 case_walk=-58 cases=-42 cash=-200
    cash_register=-191 cask=-71 castle=-42 cat=53 cat's=-42 catalog=-42 catalogue=-42 catch=-42
    cats=181 cause=-128 cease=181 ceiling=43 ceiling_=27 cellar=-200 cellar_=-121 cellar_and=-94
    cello=-71 center=-198 center_aisle=-113 centre=-42 cereal=-113 chains=-71 chair=-81
    chair_=-181 chair_and=-183 chair_by=-154 chair_is=109 chair_on=-159 chair_walk=-83
    chair_with=-94 chairs=-109 chairs_=-200 chairs_and=-200 chairs_on=-142 chairs_turn=-58
    chalkboard=-42 chambers=-42 chance=139 chandelier=-200 chandelier's=-42 chandelier_=-200
    chandelier_and=-135 change=194 change_of=200 changed=200 changed_your=200 changes=-183
    changes_from=-174 changing=-174 changing_room=-113 changing_table=-113 chapel=-183
    chapel_=-94 chapel_and=-94 characters=-42 charge=200 charger=200 charging=17
    charging_station=-164 charlie=-71 charming=-42 chart=-142 chart_table=-113 chassis=-42
    chat=181 chatting=-42 check=-164 check_in=-113 checked=139 checkerboard=-42 checkout=-94
    checkout_counter=-94 checkpoint=-42 cheerful=-42 cheers=87 cheery=-42 chess=-113 chest=-154
    chest_=-94 chest_of=-94 chick=-42 chief=200 chief_of=200 child=181 children=-71
    children's=-42 chill=-42 chimney=-94 china=-142 china_cabinet=-142 chinese=-142 chips=-42
    chocolate=-94 chocolate_fountain=-94 choices=-42 choo=-42 choose=200 choose_the=170
    christmas=-113 christmas_tree=-113 chuck=-71 chum=-42 church=-154 church_and=-94 chute=-71
    cinderella=-42 circle=33 circle_and=200 circles=181 circular=-42 circumference=-42
    circumnavigate=-42 circumstances=200 clang=-42 clank=-42 class=-94 classroom=-174
    classroom_=-94 classroom_and=-113 claw=-42 clawed=-42 cleaner=-142 cleaner_=-94 clear=8
    clear_the=-164 clearance=139 clerestory=-42 clerk's=-71 climb=-63 climb_=200 climb_down=-94
    climb_it=53 climb_the=-200 climb_to=-94 climb_up=-113 climbed=-42 climbing=-113 climbs=181
    cloakroom=-128 clock=-200 clock_=-200 clock_and=-200 clock_go=-58 clock_on=-94 clocks=-23
    clockwise=-191 close=39 close_=-113 closed=86 closed_door=-113 closely=-42 closes=-42
    closest=-200 closest_to=-154 closet=-176 closet_=-200 closet_and=-21 closet_on=-113
    closet_then=-71 closet_with=-83 closing=-71 clothes=-200 clothing=-71 clue=-42 cmd=181
    coast=-142 coat=-200 coat_hooks=-200 coat_rack=-200 coat_room=-113 coats=-154 coats_on=-94
    coca=-142 cocoa=-42 code=109 coffee=-200 coffee_machine=-142 coffee_maker=-113
    coffee_table=-200 coffees=-42 cola=-154 cold=-42 colonnade=-71 colored=-94 colored_glass=-94
    colorful=-42 coloured=-154 column=-198 column_=-94 column_on=-71 columns=-164 comb=-42
    combined=-42 come=-18 come_back=103 come_in=-113 come_on=-94 come_out=-200 come_to=-149
    comes=101 comfy=39 coming=-42 command=200 commands=200 commands_as=200 commands_be=200
    comment=181 commode=-42 companionway=-42 compass=-42 complete=200 completely=-71
    completing=181 completion=-42 compliance=181 computer=-200 computer_=-135 computer_and=-148
    computers=-128 concern=109 concession=-42 concierge=-113 concierge's=-71 concierge_desk=-94
    concrete=-142 condition=200 conditional=-42 conference=-200 conference_room=-200
    conference_table=-113 confessional=-113 confirm=-42 confuse=181 confuses=139 confusing=-42
    consecutive=-42 consider=200 consider_the=200 consideration=-42 console=-128
    console_table=-128 constant=-42 constraint=-42 cont'd=-42 contact=-113 contact_=-94
    contains=-42 content=181 continue=-10 continue_down=-148 continue_on=-142 continue_past=68
    continue_to=-200 continue_until=7 continuous=181 contrary=200 contrary_of=185 control=109
    control_room=109 conveyor=-71 cooking=181 cooler=-200 cooler_=-195 cooler_and=-128
    coordinates=-42 copier=-200 copier_=-128 copper=-71 copy=-94 corkscrew=-42 corner=-115
    corner_=-200 corner_and=-94 corner_to=-113 correct=139 correction=200 corridor=-200
    corridor_=-191 corridor_and=-121 corridor_past=-142 corridor_to=-94 costumes=-113 cot=-71
    cots=-94 couch=21 couch_=20 couch_and=-51 couch_on=-94 couch_turn=-104 couches=-200
    couches_and=-94 could=-17 could_you=7 couldn't=-42 council=181 count=88 count_the=-113
    counted=-42 counter=-200 counter_=-200 counter_and=-200 counter_clockwise=-94
    counter_turn=-71 counting=-42 country=-42 counts=200 couple=-198 couple_of=-198 course=-94
    courtyard=-174 courtyard_and=-94 cousin's=-71 cover=-94 covered=-42 cowboy=-71 cozy=-94
    cr=-142 crate=-71 crayons=-42 cream=-94 creep=181 crest=-42 crib=-200 crib_=-183
    crib_and=-113 crib_go=-94 cribs=-42 cried=-42 cross=-153 cross_on=-142 cross_over=-191
    cross_the=-200 cross_to=-94 crossed=-42 crosses=-42 crossing=109 crying=-42 crypt=-42
    crystal=-94 crystals=-42 cubbies=-71 cubicle=-128 cubicles=-113 cue=-42 cues=-42 cup=-42
    cupboard=-200 cupboard_=-113 cupboards=-42 cuppa=-42 cups=-42 curl=-42 curlers=-42
    currency=-71 current=200 currently=-42 curtain=-200 curtain_=-200 curtain_and=-200
    curtained=-71 curtains=-128 curtsy=-42 curved=-174 curved_stairs=-154 curves=-94 curving=-42
    curvy=-42 cushion=-198 cushion_=-183 cushions=-71 cut=170 cute=-94 cutest=-42 cutter=-71
    cylinder=-42 cylinders=-71 d=53 da=-71 dad=139 daddy's=-42 daft=-42 damage=181 dance=-142
    dance_floor=-128 dancer=181 dancing=-42 danger=-142 dark=-174 darkroom=-42 darling=-42
    dartboard=-164 dartboard_=-154 date=200 davenport=-71 dawdle=-94 day=200 day_=185
    daylight=-42 dead=-113 dead_ahead=-94 dear=-71 decided=181 decimetre=-42 decision=181
    deck=-97 deck_=-37 deck_with=-94 decking=-42 declare=181 decode=181 deep=-113 deer=-113
    deer_head=-113 defined=-42 definition=-42 degree=-94 degrees=-200 degrees_=-183
    degrees_and=-128 degrees_left=-113 degrees_right=-154 degrees_so=-94 degrees_to=-191
    delete=200 delivers=-42 delta=-71 demo=-142 den=-183 den_=-121 den_and=-71 denied=181
    dentist's=-42 depart=-42 department=-71 descend=-37 descend_the=-198 descending=-71
    descends=-42 describe=181 described=200 described_=200 description=200 design=-42 desk=-200
    desk_=-200 desk_and=-200 desk_on=-142 desk_the=-174 desk_to=-104 desk_turn=-94
    desk_walk=-104 desk_with=-200 desks=-200 desks_=-94 desks_and=-128 destination=137
    detailed=-42 detect=-42 detective=-42 determine=-42 developer=200 developer's=-142
    deviate=-42 deviation=-42 dexter=-42 di=-42 diagonally=-154 diagonally_to=-94
    diametrically=-42 dictionary=-71 did=200 did_last=200 different=139 ding=-71 dingy=-42
    dining=-200 dining_room=-200 dining_table=-200 dinosaur=-154 dinosaur_skeleton=-94
    direction=78 direction_of=7 direction_you=200 directional=181 directions=200 directions_=200
    directions_are=200 directions_that=172 directly=-154 directly_beneath=-94 director=181
    dirty=-42 disabled=181 disco=-71 dishwasher=-200 dishwasher_=-142 dishwasher_and=-104
    displacement=-42 display=-200 display_case=-174 disregard=200 disregard_all=157
    disregard_the=165 distance=68 distance_to=-164 distances=181 diving=-71 dizzy=-42 dj=-71
    do=170 do_=200 do_any=200 do_is=-17 do_it=200 do_me=-94 do_not=171 do_nothing=137
    do_only=200 do_that=-94 do_the=200 do_what=200 do_you=-128 dock=200 doctor=181 doctor's=17
    document=200 does=161 does_not=200 doesn't=-71 dog=-200 dog's=-42 dog_bed=-94 dogleg=-42
    doing=200 dokey=-42 doll=-42 dolls=-94 don't=-20 don't_climb=-113 don't_enter=-142
    don't_go=-48 don't_have=-94 don't_need=-94 don't_stop=7 don't_take=-2 don't_turn=-164
    done=137 done_=199 done_once=-83 done_when=-198 dong=-42 donotfollowtheroute=181 dont=181
    dooor=181 door=-122 door's=-42 door_=-150 door_a=-94 door_and=-158 door_at=-154 door_b=-94
    door_behind=-174 door_by=-94 door_go=33 door_in=-200 door_into=-142 door_is=67 door_left=-94
    door_near=-113 door_next=-164 door_not=-154 door_of=-164 door_on=-200 door_opposite=-164
    door_says=100 door_stop=-113 door_that=51 door_that's=-183 door_the=-200 door_then=-200
    door_there=-164 door_to=-200 door_turn=46 door_with=-200 door_without=-94 door_you=30
    doormat=-174 doormat_=-164 doors=-185 doors_=-182 doors_and=-200 doors_are=-94 doors_at=-94
    doors_go=-148 doors_on=-200 doors_one=-94 doors_that=109 doors_then=-178 doors_with=-94
    doorway=-147 doorway_=-41 doorway_and=-178 doorway_of=-200 doorway_on=-169 doorway_then=-58
    doorway_to=-154 doorway_walk=-15 doorway_with=-128 doorways=-42 double=-26 double_doors=-200
    doubling=-42 doubt=181 down=-95 down_=32 down_a=-128 down_and=200 down_five=-154
    down_it=-183 down_on=109 down_one=-200 down_the=-200 down_them=-183 down_three=-174
    down_to=-67 down_two=-164 down_until=-94 downstairs=-113 downwards=-42 dr=39 drafting=-94
    drafting_table=-94 drain=-71 drawbridge=-71 drawers=-154 drawers_=-113 drawing=-71 drawn=-42
    dreadful=-42 dreamy=-42 drenched=-42 dresser=-200 dresser_=-191 dresser_and=-83
    dresser_on=-58 dresser_then=-169 dresses=-71 dressing=-198 dressing_room=-191 dried=-71
    drifting=-42 drill=109 drink=-42 drinking=-142 drinking_fountain=-142 drinks=-71 drip=-42
    drive=170 drives=-42 drop=200 drop_this=140 drown=-42 drum=-191 drum_kit=-164 drums=-142
    drums_=-94 dryer=-200 dryer_=-183 dryers=-71 duck=-71 ducts=-42 ductwork=-42 dumbbells=-71
    dumpling=-42 dumpster=-71 dumpsters=-71 dungeon=-42 during=181 duties=181 duty=-42 e=-191
    each=200 each_direction=200 each_doorway=185 each_minute=185 each_other=-142 each_step=184
    each_time=200 each_turn=200 earlier=200 ears=-71 easel=-164 easel_=-94 easel_and=-128
    easiest=-42 easy=-128 eat=-71 eating=-42 ebg=181 edge=-200 edge_=-113 edge_of=-200 edges=-71
    effect=200 eggs=-71 egress=-42 egyptian=-42 eight=87 eighth=-71 either=-154 element=-42
    elephant=-71 elevation=-42 elevator=-200 elevator_=-174 elevator_and=-191
    elevator_doors=-113 elevator_lobby=-113 elevators=-191 elevators_=-154 eleven=-71 else=186
    emergency=68 emit=200 empty=-42 end=-29 end_=-171 end_and=-31 end_at=-164 end_go=-113
    end_of=-100 end_so=109 end_the=200 end_this=200 end_turn=-142 end_up=39 end_you'll=-94
    endlessly=181 ends=-46 ends_=-174 ends_at=-174 energy=181 engine=-113 engine_room=-113
    engineer=181 engineers=181 engines=181 enjoy=-42 enjoying=-42 enough=170 enter=-39
    enter_=-183 enter_a=200 enter_and=53 enter_the=-124 enter_through=-183 entering=-164
    entering_any=-94 entertainment=-71 entrance=-200 entrance_and=-94 entrance_to=-113
    entry=-142 entryway=-195 entryway_=-113 entryway_and=-71 environment=-42 episode=200
    episodes=181 equipment=-71 erase=181 erehay=181 errand=181 error=200 escalator=-200
    escalator_=-183 escalator_up=-94 escalators=-42 espresso=-71 essential=200
    essential_that=200 ethay=181 ethics=181 evacuation=-142 even=87 event=-71 ever=200 every=200
    every_door=88 every_few=157 every_instruction=200 every_landmark=200 every_order=185
    every_time=120 every_turn=200 everybody=109 everyone=151 everything=161 everywhere=109
    eway=181 ex=-42 exactly=200 exam=-94 exceed=181 except=170 exception=181 exchange=109
    exchanged=200 exclude=-42 excluded=-42 execute=87 executed=181 executing=200 execution=-42
    exercise=-191 exercise_bike=-154 exit=-200 exit's=-42 exit_=-191 exit_and=39 exit_sign=-200
    exit_the=-200 exit_through=-164 exits=-42 expanded=-42 exploring=181 exposed=-42
    extinguisher=-200 extinguisher_and=-164 extract=-42 ey=-42 eye=-113 eyepiece=-42 eyes=-94
    f=-42 face=-45 face_=-94 face_away=-113 face_the=-51 facing=-200 facing_a=-200 facing_it=-94
    facing_the=-200 failure=181 fake=-42 fall=-164 falling=-42 family=-159 family_room=-148
    fan=-113 fancy=-42 far=-200 far_as=-200 far_corner=-164 far_door=-128 far_end=-200
    far_left=-142 far_side=-154 far_wall=-198 farther=-94 farthest=-94 faster=-42 fault=181
    favor=-42 favour=-42 feel=68 feet=-65 feet_=-94 feet_from=-164 feet_to=-135 fella's=-42
    fellow=-42 fence=-128 fence_=-128 fern=-174 fern_=-164 fetched=-42 fetches=181 few=51
    few_feet=-135 few_steps=45 fgbc=181 ficus=-71 fiddling=-42 field=-42 fifteen=-42 fifth=-128
    fig=-71 file=-71 filing=-154 filing_cabinet=-128 fill=-42 filled=-42 fills=-42 film=-71
    final=-94 finally=-42 find=-200 find_a=-200 find_it=-183 find_me=-113 find_the=-200
    find_yourself=-94 fine=68 finish=154 finished=166 finished_=170 fire=-26
    fire_extinguisher=-200 fire_hose=-113 fireplace=-200 fireplace_=-200 fireplace_and=-200
    fireplace_then=-83 fireplace_to=-83 fires=-42 firewood=-71 first=-16 first_=166
    first_and=-154 first_bar=-94 first_door=-121 first_is=-94 first_landing=-200 first_left=-113
    first_of=16 first_opening=-142 first_right=-154 first_room=62 first_row=-94 first_seat=-113
    first_step=68 first_table=-113 first_two=-191 first_window=-113 first_you=-113 firstly=-42
    fish=-200 fish_tank=-200 fitting=-113 fitting_room=-94 five=-65 five_steps=-178 fixed=181
    fixtures=-42 flag=-94 flags=-142 flank=-42 flap=-94 flat=-94 flight=-200 flight_=-94
    flight_of=-200 flights=-200 flights_of=-191 flip=200 flipped=181 float=-71 floor=-46
    floor_=-103 floor_and=17 floor_changes=-164 floor_go=-94 floor_in=109 floor_is=200
    floor_lamp=-142 floorboard=-71 floors=-154 floors_=-94 flop=-71 flower=-174 flower_shop=-94
    flower_stand=-113 flowers=-183 flowers_=-113 flowers_on=-94 fluffy=-94 fold=-71 folding=-94
    follow=-42 follow_=119 follow_it=-200 follow_so=119 follow_the=-108 followed=139
    following=173 following_steps=200 following_the=53 follows=200 follows_=200 font=-174
    font_=-113 font_and=-94 food=-71 foosball=-142 foosball_table=-142 foot=-200 foot_of=-200
    footstool=-42 for=119 for_a=-38 for_all=200 for_it=87 for_me=-11 for_right=200 for_the=76
    for_this=125 for_today=200 for_you=137 for_your=147 forbid=181 forbidden=181 forbids=200
    forbids_you=200 forget=200 forget_the=59 forgetting=-42 forgot=-113 forgotten=181 fork=-174
    forks=-42 form=-71 forth=-42 forward=-113 forward_=-119 forward_and=-142
    forward_between=-113 forward_down=-94 forward_past=-183 forward_to=-142 forward_two=-94
    forwards=-42 found=200 found_it=200 fountain=-200 fountain_=-200 fountain_and=-94 four=-148
    four_step=-58 four_steps=-164 four_windows=-113 fourteen=-71 fourth=-31 fourth_door=17
    foyer=-111 foyer_=-60 foyer_and=-94 foyer_with=-83 frame=-113 framed=-113 free=-94
    freedom=-42 freely=181 freeze=139 freezer=-191 freezer_=-174 french=-200 french_doors=-200
    freshen=-42 fresher=-42 fridge=-200 fridge_=-200 fridge_and=-195 fridge_then=-104 friend=-2
    friend_=-94 friend_and=-94 friendly=-94 from=58 from_here=27 from_it=115 from_now=200
    from_the=-16 from_there=-198 from_where=109 from_your=200 front=-146 front_=68
    front_desk=-174 front_door=-85 front_of=-179 front_pew=-94 frosted=-71 frozen=139 fruit=-94
    ft=-142 full=10 full_access=185 full_of=-164 fully=-42 fun=68 function=-42 functional=-42
    funnily=-42 furnace=-71 furniture=200 further=200 further_=113 fuse=-71 fuss=-42 future=181
    gallery=-174 gallery_=-94 gallery_and=-113 galley=-94 game=-174 game_room=-164 gangway=-71
    gap=-200 gap_between=-94 garage=-85 garage_=-21 garage_by=-71 garage_go=-83 garden=-31
    garden_=39 gardening=-42 gas=-113 gate=-200 gate_=-200 gate_and=-94 gate_in=-113 gave=200
    gawp=-42 gazebo=-71 gears=181 geese=-42 general=200 generator=-113 generator_=-113
    generous=181 gentle=-71 gently=-71 get=-194 get_in=-113 get_off=-94 get_out=-200 get_there=7
    get_to=-200 get_you=-113 gets=-42 getting=-42 giant=-142 gift=-183 gift_shop=-183 give=7
    give_it=-94 given=200 given_=200 gives=200 giving=-42 glamorous=-42 glass=-163 glass_=39
    glass_and=-94 glass_case=-94 glass_door=-200 glass_doors=-200 glass_table=-200
    glass_walls=-113 glass_window=-113 glasses=-128 glasses_=-94 glazed=-71 glazing=-42
    globe=-200 globe_=-183 globe_and=-128 globes=-42 glowing=-71 glug=-42 go=-101 go_=88
    go_across=-94 go_ahead=-142 go_all=-200 go_along=-200 go_and=-164 go_any=53 go_anywhere=200
    go_around=-200 go_back=188 go_backward=200 go_behind=-113 go_between=-200 go_by=-200
    go_down=-200 go_forward=-35 go_from=-174 go_halfway=-94 go_home=200 go_in=-88 go_inside=-113
    go_into=-107 go_left=-78 go_on=28 go_out=-200 go_outside=-200 go_over=-94 go_past=-200
    go_right=-64 go_round=-53 go_slightly=-128 go_straight=-200 go_the=170 go_there=53
    go_through=-182 go_to=-106 go_toward=-200 go_towards=-191 go_under=-191 go_up=-176 goal=200
    goal_=200 goal_is=113 goals=181 goes=63 goes_to=-113 going=-98 going_down=-154 going_in=-142
    going_left=-94 going_past=-128 going_straight=-178 going_through=-128 going_to=-2
    going_until=-200 going_up=-164 gold=-200 golden=-94 gone=-31 gone_past=-94 good=163
    good_=200 goodbye=181 goodies=-42 gorgeous=-113 got=-200 got_a=-198 got_to=-94 gowns=-42
    grab=-42 gradient=-42 gramophone=-71 gramophone's=-42 gran's=-42 grand=-42 grandad's=-42
    grandfather=-200 grandfather_clock=-200 grass=-142 grate=-42 grating=-42 graveyard=-71
    gray=-200 great=87 green=-200 green_=-142 green_chair=-113 green_chairs=-113 green_door=-128
    greenhouse=-42 greeted=-71 grey=-200 grey_couch=-83 grill=-200 grill_=-200 ground=-94
    ground_floor=-94 grown=-113 guard=200 guard's=-164 guard's_chair=-164 guardrail=-42
    guess=-94 guest=30 guest_room=-198 guests=181 guidance=181 guitar=-113 gumball=-113
    gumball_machine=-113 gun=-142 gym=-200 gym_and=-121 gym_with=-94 gymnasium=-94 ha=-71 had=39
    haha=-42 hair=-128 half=40 half_landing=-94 half_of=200 half_right=-94 halfway=-200
    hall=-200 hall's=-42 hall_=-200 hall_and=-114 hall_by=-128 hall_into=-142 hall_of=-113
    hall_then=-159 hall_through=-94 hall_turn=-83 hall_with=-164 hallway=-174 hallway_=-164
    hallway_and=-200 hallway_as=-94 hallway_in=-94 hallway_on=-191 hallway_past=-200
    hallway_splits=-174 hallway_then=-128 hallway_to=-174 hallway_turn=-121 hallway_with=-200
    hallways=-94 hallyway=-142 halt=54 halt_=77 halt_at=-6 halt_by=-94 hammock=-128 hamper=-142
    hamper_and=-94 hamster=-71 hand=51 hand's=181 hand_=87 hand_door=-142 hand_for=200
    hand_side=-198 handedness=181 handles=-71 handrail=-142 hands=139 hang=-200 hang_a=-200
    hanging=-200 hanging_on=-142 hangs=-174 hansen=181 happens=181 happy=-142 hard=-200
    hard_left=-164 hard_right=-94 hard_to=-113 hardwood=-71 harp=-198 harp_=-94 harp_and=-128
    harpsichord=-113 harpsichord_=-113 has=191 has_a=-200 has_been=200 has_cancelled=172
    has_changed=200 has_closed=200 has_no=109 has_to=200 has_withdrawn=140 hat=-191 hat_=-94
    hat_stand=-113 hatch=-198 hatch_=-174 hats=-42 have=151 have_a=27 have_arrived=124
    have_been=200 have_found=200 have_gone=27 have_reached=113 have_to=67 having=-94 hay=-142
    he=96 he's=-42 head=-11 head_down=-128 head_for=-154 head_of=200 head_office=200 head_on=-94
    head_out=-154 head_straight=-94 head_through=-94 head_to=-200 head_towards=-187 heading=-200
    heading_you=-94 headquarters=181 headroom=-42 heads=-42 health=181 hear=170 heard=200
    heart=-42 hearth=-71 heated=-42 heater=-128 heater_=-94 heave=-42 heavy=-164 hedge=-113
    heed=181 height=-71 helical=-42 hello=87 help=-71 helps=-71 hence=-71 her=-113 here=147
    here's=-94 here_=127 here_and=200 hereby=200 herein=181 hex=181 hey=129 hi=68 hidden=-71
    hiding=-42 high=-200 high_chair=-142 high_chairs=-94 higher=53 highest=-71 hill=-42 him=-200
    him_=-191 hint=-42 his=-128 hit=68 hit_the=-113 hm=-42 hold=8 hold_=68 hold_at=-198
    hold_by=-113 hold_on=-200 hold_position=87 holder=-174 holder_=-83 holder_and=-104
    holding=-42 holds=-42 hole=-71 home=200 home_=200 hon=-42 hook=-128 hooks=-200 hooks_=-200
    hooks_and=-113 hoop=-71 hooray=-42 hoover=-94 hop=87 horizontal=109 horse=-200 horse's=-42
    horse_=-183 horses=-42 hose=-142 hose_=-128 hospital=-10 hospital_bed=-183 hot=-200
    hot_tub=-200 hotel=-183 hour=181 hours=181 house=85 house_=117 houses=-42 hover=-42 how=-128
    how_to=-94 huge=-128 human=181 hun=-42 hung=-42 hungry=-42 hunt=-42 hurry=-191 husband=-42
    hut=-71 i=116 i'd=170 i'll=17 i'm=-174 i've=-128 i've_got=-113 i_am=200 i_can't=109 i_e=-183
    i_have=200 i_know=-128 i_left=-142 i_mean=-191 i_need=39 i_say=77 i_want=-200 ice=-200
    ice_cream=-94 ice_machine=-200 idea=-42 identical=-42 idle=-42 if=84 if_it=53 if_they=200
    if_you=39 if_you're=-94 ignore=137 ignore_the=99 ignored=-42 ignorethenextstep=181
    ignoring=139 ii=-71 iii=-71 ikea=-142 image=181 imagine=109 immaterial=-42 immediate=200
    immediately=24 immediately_=109 immediately_and=109 important=181 in=-25 in_=-86 in_a=-52
    in_all=200 in_an=-142 in_and=-200 in_at=-164 in_between=-200 in_by=-94 in_charge=200
    in_closet=-154 in_front=-177 in_go=170 in_it=-24 in_place=200 in_reverse=200 in_that=-128
    in_the=-109 in_there=-123 in_this=200 in_through=-191 in_turn=17 in_you=109 in_your=200
    inch=181 inclination=-42 increased=181 indefinitely=181 indications=181 indoor=-71
    indoors=-42 infiltrate=-42 information=-113 ingress=-42 initial=109 injured=181 inner=-94
    innocent=-42 inside=-200 inside_=-200 inside_and=-178 inside_it=-94 inside_the=-200
    inside_then=-71 inside_through=-159 insists=-42 inspector=181 inspectors=181 instance=-42
    instead=132 instead_=200 instead_of=67 instruction=200 instruction_=200 instructions=166
    instrument=-42 interchanged=181 intermediate=-42 internal=-42 interpret=200 intersection=-71
    intersects=-42 intervening=-42 into=-159 into_a=-63 into_it=-94 into_the=-200 invert=181
    inverted=200 inviting=-42 iron=-198 iron_door=-142 iron_gate=-94 ironing=-174
    ironing_board=-174 is=105 is_=-17 is_a=16 is_an=53 is_and=87 is_at=7 is_behind=-174
    is_called=68 is_cancelled=100 is_closed=115 is_essential=200 is_in=17 is_just=-94
    is_left=-94 is_named=200 is_next=-174 is_no=200 is_not=200 is_nothing=77 is_off=200
    is_on=-54 is_only=100 is_open=39 is_out=200 is_right=170 is_the=-33 is_to=190 is_void=200
    is_where=-200 is_written=200 is_wrong=200 is_your=27 is_yours=-94 island=-200 island_=-135
    island_and=-135 island_on=-121 isn't=87 issue=200 issued=200 it=33 it'll=68 it's=-72
    it's_a=-31 it's_got=-128 it's_just=-94 it's_left=-94 it's_like=-113 it's_not=-94
    it's_the=-200 it_=8 it_a=-113 it_and=-132 it_by=-94 it_curves=-94 it_down=-94 it_ends=39
    it_go=-113 it_goes=-94 it_has=59 it_in=109 it_into=-94 it_is=86 it_looks=-164 it_on=-200
    it_right=87 it_says=200 it_stop=-94 it_tells=119 it_the=170 it_then=-94 it_there's=-113
    it_through=-142 it_to=-83 it_turn=-128 it_until=-113 it_was=200 it_with=68 it_you=-94
    item=-42 itinerary=181 its=-51 its_end=-200 its_far=-164 its_left=-183 its_near=-94
    its_right=-200 its_tail=-94 itself=-94 iv=-128 jackets=-142 jackets_=-113 jacuzzi=-159
    jacuzzi_and=-94 jacuzzis=-23 jigsaws=-42 job=115 job_is=87 jog=-42 joke=181 journey=109
    journey_ends=109 judge's=-42 jug=-71 juice=-94 jukebox=-154 jukebox_=-113 junction=87
    just=-42 just_a=-174 just_after=-94 just_before=-200 just_go=-58 just_inside=-200
    just_outside=-178 just_past=-94 just_stop=-128 just_to=-94 just_turn=-94 just_walk=-113
    k=-71 keep=-21 keep_going=-129 keep_on=-191 keep_out=109 keep_right=-94 keep_the=-200
    keep_to=-200 keep_turning=200 keep_walking=-37 keeping=-200 keeping_it=-183 keeping_the=-142
    keeping_them=-94 keeping_to=-128 keeps=-71 kept=-71 kettle=-42 kevin=-42 key=-42
    keyboard=-113 keypad=-71 keys=-154 kick=-42 kiddies=-42 kidding=139 kids=-42 kill=-142
    killing=-71 kiln=-42 kind=53 kind_of=-94 kindly=200 kindness=-42 king=-71 king's=-42
    kiosk=-71 kit=-200 kit_=-174 kitchen=-83 kitchen_=-126 kitchen_and=-2 kitchen_door=87
    kitchen_doorway=-94 kitchen_island=-200 kitchen_now=-142 kitchen_past=-94 kitchen_sink=-113
    kitchen_through=-135 kitchen_with=-94 kitchen_you=-191 kitchenette=-113 knee=-42 knees=-42
    knife=-71 knight=-42 knob=-71 knock=-71 knocker=-71 know=-2 knows=181 l=-200 l_=-164 la=-42
    lab=-71 label=200 labelled=-142 lad=-42 ladder=-200 ladder_=-191 ladder_and=-200
    ladder_on=-113 ladder_to=-94 ladies=-42 lady=-94 lady's=-42 lamp=-200 lamp_=-200
    lamp_and=-200 lamp_on=-164 lamps=-198 landing=-200 landing_=-200 landing_and=-183
    landing_turn=-154 landings=-42 landlord=181 landmark=200 landmark_is=200 landmarks=-42
    landscape=-71 lane=-42 lantern=-71 lap=-113 large=-200 largest=-42 last=64 last_=200
    last_door=-104 last_every=119 last_one=-37 last_step=113 last_stool=-113 last_thing=-191
    lasts=200 lasts_=172 later=181 lateral=139 lathe=-71 latin=-42 laugh=181 laundry=-200
    laundry_basket=-174 laundry_room=-200 lava=-71 law=181 lawful=181 lawn=-71 lawyers=181
    layman=-42 lead=59 leading=-113 leads=-128 leaf=-42 leaning=-71 learn=-42 least=181
    leather=-200 leather_chair=-83 leather_couch=-94 leave=9 leave_=113 leave_by=-198
    leave_it=109 leave_the=-59 leave_this=125 leave_through=-183 leaves=-71 leaving=-200
    leaving_the=-200 left=-147 left_=-151 left_90=-142 left_across=-94 left_after=-200
    left_again=-200 left_along=-113 left_and=-161 left_around=-198 left_as=-49 left_at=-200
    left_before=-128 left_by=-142 left_corner=-142 left_down=-142 left_enter=-135 left_for=84
    left_go=-200 left_halfway=-94 left_hall=-94 left_hand=-10 left_in=-198 left_into=-114
    left_is=137 left_just=-94 left_my=-154 left_not=-113 left_of=-200 left_one=-183 left_out=53
    left_pass=-94 left_past=-195 left_side=-200 left_so=-142 left_staircase=-94 left_the=-154
    left_then=-200 left_there=-200 left_through=-198 left_to=-63 left_towards=-113 left_turn=83
    left_until=-154 left_up=-94 left_walk=-113 left_wall=-128 left_when=87 left_where=-128
    left_with=53 leftmost=-113 lefts=-42 leftward=-42 leg=-198 legend=-42 lego=-142 legs=-42
    leisurely=-42 lemon=-71 length=-183 length_of=-113 lent=-42 less=-42 let=87 let's=-80
    let's_get=-128 let's_start=-94 letter=147 letters=-142 level=-128 librarian=-42 library=-200
    library_=-113 library_and=-113 lie=-71 lied=181 lies=181 lieu=-42 life=77 life_jackets=-142
    lifeboat=-113 lifeboat_=-94 lifeboats=-113 lifebuoy=-113 lifebuoy_=-113 lifeguard=-94
    lifeguard's=-42 lift=-6 lift_=-17 lifts=-42 light=-183 lighted=-42 lighthouse=-71 lights=-94
    like=-4 like_a=45 like_the=-154 like_you're=-174 limb=-42 limit=-42 limits=139 line=-103
    line_on=-154 lined=-42 linen=-200 linen_closet=-191 linen_cupboard=-94 lines=-154 lintel=-42
    lion=-142 lions=-71 list=200 listen=-42 lit=-94 literally=-71 little=-200 little_=-164
    little_and=-142 little_bit=-94 little_hallway=-94 little_table=-94 living=-92
    living_room=-92 load=-42 loading=-71 lobby=-200 lobby's=-42 lobby_=-200 lobby_and=-200
    lobby_to=-94 lobby_with=-94 locate=-198 locate_a=-142 locate_the=-94 location=139 locked=129
    locker=-94 locker_room=-94 lockers=-200 lockers_=-191 lockers_and=-154 locomotion=181
    loft=-191 loft_=-154 login=-142 lol=181 long=-56 long_as=200 long_hallway=-113 long_part=-94
    long_table=-83 long_wooden=-94 longer=200 loo=-71 loo's=-42 look=-87 look_at=17
    look_down=-94 look_for=-137 look_to=-94 looking=72 looking_at=-191 looking_for=170 looks=-6
    looks_like=43 loom=-71 loop=181 loose=-42 lose=-42 lost=-128 lot=-164 lot_of=-128 lots=-154
    lots_of=-154 loud=-42 loudspeakers=-42 lounge=-200 lounge_=-128 lounge_and=-128
    lounge_chairs=-128 lounge_go=-58 lounger=-71 loungers=-128 loungers_=-94 love=-94
    lovely=-174 low=153 lower=-113 lowest=-42 luck=-42 lucky=-42 luggage=-113 lunch=-113
    lying=181 m=-200 m_=-164 m_and=-94 machine=-200 machine's=-42 machine_=-200 machine_and=-200
    machine_on=-142 machine_then=-104 machine_with=-94 machines=-195 machines_=-128 made=43
    made_of=-154 made_out=-94 magazine=-71 magazines=-113 magazines_=-94 magnificent=-42
    magnitude=-42 mailbox=-154 mailbox_=-113 mailboxes=-183 main=-142 maintain=-42 majesty=-42
    make=-168 make_a=-200 make_for=-164 make_your=-200 maker=68 makers=181 makes=-142 makeup=-94
    making=-94 man=88 management=200 manager=200 manager's=-113 mannequin=-142 mannequin_=-94
    mannequins=-71 manoeuvre=181 mantelpiece=-42 manufacturer=200 many=-94 map=147 map's=-42
    map_=-154 marble=-200 marble_bust=-113 marble_stairs=-113 marble_statue=-113 march=-71
    margin=181 mark=-94 marked=-164 market=-42 married=-42 marshal=200 marta=181 masks=-71
    massage=-200 massage_room=-113 massage_table=-154 massages=-42 massive=-42 master=-154
    master_bedroom=-154 mat=-200 mat_=-200 mate=-71 mats=-71 matter=200 may=200 maybe=-42 me=63
    me_=67 me_a=-154 me_to=200 mean=-10 mean_the=-94 meaning=-71 means=151 meant=96 measure=181
    measuring=-42 meet=139 meeting=-164 meetings=-42 memory=200 mention=181 mentioned=200
    mentioned_=200 mere=-42 mess=-128 message=200 message_from=200 metal=-200 metal_stairs=-164
    meteor=-42 meteorite=-71 meter=-113 meters=-200 meters_=-94 meters_and=-142 metre=-42
    metres=185 mezzanine=-71 microfilm=-71 microwave=-200 microwave_=-187 microwave_and=-83
    microwaves=-23 middle=-133 middle_=-113 middle_aisle=-113 middle_and=-94 middle_between=-113
    middle_of=-45 middle_one=-113 midpoint=-42 might=-142 milk=-94 miller's=-142 million=-42
    mind=116 mind_=109 mind_the=27 mine=-71 mine's=-42 minerals=-71 mini=-71 minimise=-42
    minimum=-42 ministry=181 mint=-42 minus=-71 minute=200 minute_=200 minutes=181 mirror=-101
    mirror_=-200 mirror_and=-187 mirror_on=-113 mirror_then=-94 mirror_with=-94 mirrored=165
    mirrored_=200 mirrored_wall=-113 mirrors=-200 mirrors_=-94 mirrors_on=-164 misc=-142
    misreading=-42 miss=139 misses=-42 missing=-42 mission=68 mistake=200 mister=-42
    mistletoe=-71 mix=200 mode=200 moment=200 money=-71 monitors=-71 mood=-42 mop=-154 more=76
    more_=200 more_step=-113 more_steps=-142 more_than=200 mosey=-113 most=-42 mother=53
    mother's=-42 motion=200 motionless=181 motors=181 mount=-42 mountains=-71 mounted=-71
    move=108 move_=200 move_away=-195 move_forward=-164 move_toward=-178 movement=200 moves=139
    movie=-42 moving=154 moving_=157 moving_walkway=-154 much=181 mud=-178 mud_room=-178
    mudroom=-71 mum=139 mum's=-42 mummies=-71 mummy=-142 mummy's=-42 mummy_and=-113 museum=-128
    museum_in=-94 music=-142 music_room=-142 must=200 must_go=200 must_not=200 my=64
    my_friend=68 my_mother=53 n=181 nag=-42 nah=181 nail=-71 name=109 named=200 named_=200
    narrator=181 narrow=-200 narrow_hallway=-113 narrow_passage=-94 naturally=-42 nave=-94
    navigation=200 nd=147 near=-54 near_it=-113 near_the=-121 nearer=-42 nearest=-69
    nearest_mirror=-94 nearest_the=-164 nearest_toilet=-183 nearly=-71 necessary=181 need=94
    need_a=39 need_is=-10 need_not=200 need_to=27 needed=-42 needn't=-42 negate=181 negative=109
    neighbor=-42 neighborhood=-42 neighbour=181 neither=-42 nemo=-42 neon=-94 nephew=-42
    never=200 never_mind=100 new=200 newel=-71 news=181 newspaper=-71 newspapers=-113
    newspapers_=-94 newsstand=-71 next=-68 next_=191 next_door=-200 next_left=-83 next_one=68
    next_room=-164 next_to=-200 nice=-191 nicer=181 niche=-71 night=-42 nightstand=-191
    nightstand_=-113 nine=-113 ninety=-183 ninety_degrees=-113 nip=-71 no=132 no_=200
    no_further=-154 no_longer=200 no_more=-142 no_need=200 nobody=192 nominal=-42 none=200
    none_of=200 nonsense=181 nook=-200 nook_=-159 nook_and=-113 nook_with=-83 normal=-113
    north=-113 northbound=-42 nose=-94 not=142 not_a=87 not_allow=200 not_do=200 not_enter=200
    not_go=73 not_move=200 not_pass=53 not_right=-94 not_stop=43 not_take=132 not_that=39
    not_the=-145 not_to=77 not_turn=113 not_up=-94 not_use=151 not_walk=200 note=200 nothing=135
    nothing_=200 nothing_in=53 notice=199 notice_a=51 notice_board=-94 notice_the=200
    notice_your=157 noticeboard=-42 noting=-42 november=-42 now=43 now_=200 now_and=170
    now_go=-142 now_in=-200 now_on=200 now_so=-142 now_there=109 now_turn=-164 now_walk=-142
    now_you=-200 now_you're=-174 nowhere=-42 nulling=-42 number=50 number_three=-113 numbers=-42
    nurse=200 nurse's=-174 nursery=-200 nursery_=-159 nursery_and=-178 nursery_then=-71
    nurses=-128 nurses_station=-94 o=-142 o'clock=-198 o'clock_and=-94 obey=200 obeyed=200
    obeyed_=200 object=200 objective=-94 oblique=-71 observation=-42 obstacle=-71 obstacles=-42
    obvious=-42 obviously=-71 occupies=-42 occurs=-42 ocean=-42 octagonal=-71 of=-23 of_3=-94
    of_90=-94 of_a=-125 of_all=129 of_an=-94 of_apples=-94 of_armor=-154 of_black=-94
    of_chairs=-159 of_doors=-2 of_drawers=-94 of_each=200 of_every=200 of_feet=-164
    of_flags=-113 of_green=-113 of_it=-81 of_management=172 of_one=-94 of_seats=-142
    of_stairs=-200 of_steps=-154 of_tables=-94 of_that=68 of_the=-70 of_them=-80 of_these=200
    of_this=200 of_those=-113 of_three=-94 of_what=200 of_which=-94 of_white=-113
    of_windows=-113 of_you=-73 of_your=194 off=94 off_=200 off_from=-94 off_the=-2 off_to=-113
    offer=-42 office=-45 office_=-118 office_and=-200 office_does=119 office_has=200
    office_with=-121 officer=200 official=200 offline=181 offset=-42 ok=200 ok_=200 okay=-94
    okay_=109 okay_so=-128 okey=-42 old=43 old_man=-94 older=-42 ollie=-42 on=-106 on_=-30
    on_a=-97 on_and=-17 on_both=-128 on_by=-94 on_down=-94 on_going=-128 on_it=-96 on_its=-200
    on_left=-142 on_out=-94 on_past=-174 on_right=-164 on_straight=-94 on_the=-135 on_this=39
    on_through=-113 on_to=-200 on_top=-94 on_treat=200 on_until=68 on_up=-94 on_wheels=-113
    on_your=-188 once=66 once_=200 once_and=53 once_every=157 once_so=119 once_the=-94
    once_there=-94 once_you=-38 once_you're=-94 once_you've=-94 one=-67 one's=-94 one_=-79
    one_after=-94 one_and=-53 one_deck=-94 one_door=-94 one_flight=-200 one_floor=-154
    one_in=-142 one_is=68 one_more=-113 one_of=-128 one_on=-200 one_side=68 one_step=-200
    one_that=-164 one_too=87 one_two=-94 one_up=-94 one_who=200 one_with=-200 one_you=-200
    ones=68 ones_=87 only=112 only_=200 only_and=27 only_one=-198 only_the=137 onto=-200
    onto_the=-200 ooh=-71 oops=-154 open=-145 open_=-154 open_door=-200 open_doorway=-183
    open_it=-113 open_the=-174 opening=-200 opening_=-94 opening_and=-94 opening_in=-128
    opening_on=-128 opens=-200 opens_on=-94 opera=-42 operational=181 operator=200
    operator's=181 operator_has=119 operators=181 opposite=143 opposite_=113 opposite_of=200
    opposite_the=-198 optical=-42 optional=181 options=-42 or=-48 or_down=53 or_what=-94
    orange=-200 orchids=-42 order=200 order_=200 order_of=200 ordered=181 orders=200 orders_=200
    orders_so=140 orders_you=140 organ=-128 organ_pipes=-94 orientation=-42 origin=-42 other=82
    other_=151 other_end=27 other_hand=200 other_one=-154 other_side=-64 other_way=175
    others=139 otherwise=181 ottoman=-195 ottoman_=-154 ought=200 our=137 ours=-71 out=-51
    out_=104 out_and=-198 out_at=-94 out_by=-183 out_from=-94 out_in=-113 out_into=27
    out_of=-109 out_on=-128 out_onto=-200 out_past=-94 out_the=22 out_through=-200 out_to=-200
    out_turn=-154 outdoor=-71 outer=-42 outeray=181 outline=181 output=181 outrank=181
    outside=-100 outside_=-19 outside_and=-135 outside_it=-113 outside_of=-128 outside_on=-142
    outside_room=-94 outside_the=-200 outside_then=-83 outside_through=-113 oval=-159 oven=-200
    oven_=-200 oven_and=-104 oven_on=-94 over=-75 over_the=-200 over_to=-76 override=165
    overwrite=181 own=200 own_axis=200 owner=200 owner's=-113 owner_of=200 paces=-42 page=181
    paint=-94 painted=39 painting=-200 painting_=-159 painting_and=-83 painting_of=-128
    paintings=-183 paintings_=-164 pair=-154 pair_of=-128 pairs=-42 pajamas=-42 pal=-71 pale=-42
    pallet=-71 pallets=-42 palm=-154 pane=-42 panel=-198 pantry=-200 pantry_=-148 pantry_and=-71
    pantry_door=-113 pantry_with=-83 paper=-113 papers=-42 par=-113 paragraph=181 parallel=-71
    parish=-42 park=-142 parked=-71 parking=-71 parlor=-42 parlour=-42 part=137 part_of=151
    party=-42 pass=-143 pass_2=-104 pass_a=-200 pass_between=-113 pass_four=-94 pass_it=39
    pass_one=-113 pass_something=172 pass_the=-170 pass_three=-183 pass_through=-113
    pass_to=-142 pass_two=-195 pass_under=-94 passage=-198 passage_and=-113 passed=53 passes=-94
    passing=-154 past=-200 past_=109 past_a=-200 past_all=-191 past_both=-128 past_every=-191
    past_four=-128 past_it=-72 past_six=-94 past_the=-200 past_them=-164 past_three=-113
    past_two=-200 pat=-42 patch=-42 path=-15 path_=-94 path_that=87 patience=181 patio=-200
    patio_=-121 patio_and=-200 patio_turn=-71 patrol=-42 pause=53 pay=17 pea=-42 peanuts=-71
    pears=-42 peasy=-42 pebbles=-42 pedestal=-71 peek=-71 peel=-71 pegs=-113 penguin=-113
    people=3 people_sitting=-174 percent=181 perfect=-42 perform=200 pergola=-42 perimeter=181
    permission=181 permit=139 permitted=181 perpendicular=-42 persian=-71 person=200
    person_in=200 person_who=166 personnel=181 petal=-42 peter=181 pew=-191 pew_=-113 pews=-198
    pews_=-94 pews_on=-94 phase=-164 phone=-183 phone_=-113 phone_booth=-128 photo=-71
    photographs=-71 photos=-142 photos_on=-113 piano=-200 piano_=-200 piano_and=-148
    piano_then=-71 pianos=-121 pick=113 picture=-92 picture_=-148 picture_of=-183 pictures=-113
    piece=-42 pillar=-200 pillar_=-174 pillar_and=-113 pillar_turn=-83 pillars=-169
    pillars_and=-128 pillows=-71 pinball=-113 pinball_machine=-113 pinch=-42 ping=-174
    ping_pong=-174 pink=-191 pins=-42 pipes=-154 pit=-113 pitch=-42 pivot=109 place=200
    place_=191 place_where=200 plan=200 plan_=200 plane=-71 planetarium=-42 planets=-71
    planned=181 plant=-200 plant_=-200 plant_and=-200 plant_in=-113 plant_on=-58 plant_take=-58
    plant_turn=-135 planters=-71 plaque=-164 plaster=-42 plastic=-94 plate=139 plates=-113
    play=-71 player=-128 player_=-94 playhouse=-42 playing=-42 playroom=-154 please=165
    please_=24 please_do=200 please_don't=200 please_return=200 please_walk=51 plinth=-42
    plonk=-71 plotter=-71 pls=181 plunge=-174 plunge_pool=-174 plus=-42 po's=-142 pocket=-42
    podium=-113 point=51 point_=39 points=-94 pointy=-42 poke=-42 pole=-42 police=200 policy=181
    polish=-71 pommel=-71 pond=-71 pong=-174 pong_table=-174 pool=-200 pool_=-164 pool_and=-200
    pool_table=-200 pool_with=-94 pop=-113 popcorn=-174 poppet=-42 porch=-200 porch_=-200
    porch_and=-159 porches=181 port=-71 portable=-42 porthole=-113 porthole_=-94 portholes=-71
    portrait=-191 portrait_=-113 portraits=-71 portside=-42 pose=109 position=115 post=-154
    post_=-94 postcards=-71 postcondition=-42 poster=18 pot=-154 pot_=-94 pots=53
    pots_hanging=-94 potted=-200 potted_palm=-128 potted_plant=-200 potted_tree=-128 pottery=-94
    potting=-71 pouffe=-42 poultry=-42 powder=-42 power=153 prams=-42 prayer=-71
    preconditions=-42 prep=-42 present=200 presents=-42 press=-71 pressure=-71 pretend=139
    pretty=-174 previous=200 principal's=-71 principle=181 print=109 printed=200 printer=-174
    printer_=-94 printer_and=-113 printers=-71 prior=-42 priority=-42 privacy=181 private=-113
    privileges=181 prize=-42 proceed=-111 proceed_past=-178 proceed_to=7 projection=-42
    projects=-42 pronto=-42 proof=-71 proud=-71 psst=181 pub=-42 pucker=-42 pull=-42 pulled=-42
    pulpit=-154 pulpit_=-94 pump=-71 pup's=-42 puppet=-113 puppet_theater=-94 purple=-200
    purposes=181 pursuant=181 push=-198 put=130 put_=200 puts=-71 putting=-71 pyjamas=-42 q=-42
    qty=-42 quarter=-71 query=-42 questions=139 queue=139 quick=-154 quickly=-113 quiet=-154
    quietly=-71 quilt=-71 quilts=-42 quite=-42 r=-191 rack=-200 rack_=-200 rack_and=-200
    rack_of=-142 rack_on=-113 rack_with=-113 racks=-148 racks_=-94 radiator=-164 radiator_=-142
    radiators=-113 rail=-191 railing=-200 railing_=-183 railing_and=-142 railing_on=-183
    railing_to=-154 railings=-94 rails=-94 rain=-71 ramp=-200 ramp_=-200 ramp_and=-200
    ramp_on=-94 range=-71 rather=200 rather_than=200 ray=-71 rd=-42 reach=-91 reach_it=-113
    reach_the=-114 reached=199 reached_the=166 reaching=-113 reaching_it=-113 read=200
    read_is=200 read_the=166 read_this=200 reader=109 reading=39 reads=124 ready=-71 real=17
    really=-142 rear=68 rear_door=-94 rearward=-42 rearwards=-42 reason=200 reasons=181
    recall=181 receive=181 reception=-200 reception_=-121 reception_desk=-200 recessed=-42
    recipe=-42 reciprocal=-42 recliner=-71 recliners=-71 record=-113 record_player=-113 red=-200
    red_carpet=-183 red_curtain=-154 red_door=-154 red_fridge=-94 red_line=-94 red_sofa=-113
    reference=-42 reflection=181 reflective=-94 refrain=200 refrigerator=-200 refrigerator_=-200
    refrigerator_and=-83 refrigerator_turn=-58 refuse=181 refused=181 regardless=181
    register=-200 register_=-154 regulation=181 reinstate=181 reject=181 relaid=-42 relax=139
    released=181 relieved=-71 remain=200 remainder=200 remaining=53 remains=139 remember=200
    remember_to=200 remind=-42 remove=181 repeat=87 repeated=139 replace=200 replaced=200
    replacement=181 report=200 request=200 requested=181 requesting=-42 requests=181 require=-42
    required=-71 requirement=-42 requires=200 rescinded=181 research=181 respect=181 rest=200
    rest_=185 rest_of=200 restaurant=-113 restaurant_and=-94 restroom=-71 restrooms=-71
    result=-71 retrace=117 retrace_your=45 return=200 return_to=200 reverse=167 reverse_of=200
    reversed=181 revert=181 revoked=181 revolution=-42 revolving=-183 revolving_door=-183
    rewarded=-42 ride=-128 riding=-42 right=-123 right's=-42 right_=-111 right_a=-94
    right_after=-200 right_again=-198 right_along=-113 right_and=-200 right_angle=-94
    right_around=-148 right_as=-90 right_at=-148 right_before=-31 right_beside=87 right_by=-191
    right_corner=-164 right_down=-94 right_go=-200 right_hand=-200 right_immediately=-113
    right_in=30 right_instead=53 right_into=-200 right_is=27 right_just=-200 right_now=-128
    right_of=-200 right_off=-94 right_on=-128 right_one=-183 right_past=-187 right_right=-164
    right_side=-200 right_so=-2 right_stop=-71 right_take=-94 right_then=-200 right_there=-60
    right_to=24 right_towards=-164 right_turn=-17 right_until=-164 right_up=-128 right_wait=-154
    right_walk=-200 right_wall=-142 right_when=-142 right_with=-113 righto=-42 rightwards=-42
    righty=-42 rim=-42 ring=-94 rink=-42 riser=-42 risers=-42 rises=-42 riverside=-198 road=-94
    robes=-71 robot=77 robotics=181 robots=200 robots_must=200 rock=-42 rocking=-200
    rocking_chair=-198 rocking_horse=-94 rocks=-113 role=181 roll=87 rolled=-128 rolled_up=-94
    roller=-71 rolling=-42 rolls=-42 roman=-71 roof=-154 roof_=-94 room=-105 room's=-71
    room_=-111 room_after=-23 room_and=-200 room_before=151 room_between=-94 room_by=-128
    room_door=-128 room_for=87 room_go=-128 room_has=61 room_is=39 room_on=-200
    room_opposite=-164 room_past=-94 room_straight=-128 room_that=129 room_the=-164
    room_then=-200 room_through=-135 room_to=-198 room_turn=-195 room_using=-187 room_where=-154
    room_which=-94 room_with=-193 room_you=-198 rooms=99 rooms_=109 root=181 rope=-200
    rope_barrier=-113 rotate=70 rotate_twice=185 rotating=181 rotation=68 roughly=-71 round=-18
    round_=200 round_and=17 round_dining=-94 round_it=-113 round_table=-142 round_tables=-113
    round_the=-200 round_to=-113 rounded=-42 rounding=-42 route=200 route_=200 route_and=200
    route_is=200 routes=181 row=-200 row_=-142 row_and=-113 row_of=-200 rowing=-113 rows=-191
    rows_of=-164 rubber=-71 rubbish=-42 rug=-200 rug_=-200 rug_and=-200 rug_ends=-94 rug_in=-164
    rug_to=-83 rule=200 rules=200 run=200 run_lasts=200 runner=-142 runner_rug=-113 running=-71
    runs=-113 rush=-42 s=-42 saddle=-128 saddle_=-94 safe=-94 safest=181 safety=200
    safety_officer=172 said=200 sailor=-42 salad=-113 salon=-113 saloon=-71 same=-48 sandbox=-94
    sanitary=-42 saturn=-71 sauna=-200 sauna_=-121 sauna_and=-121 sauna_go=-83 sausage=-42
    saw=139 say=113 say_hi=-94 say_that=200 saying=39 says=200 says_=200 says_stop=-191
    says_that=200 scale=-200 scale_=-183 scales=-71 scary=-42 school=-113 science=-71
    sconces=-42 scoot=-94 scrap=200 scratch=181 screen=-200 screen_=-200 screen_door=-154
    screens=-164 scroll=-142 scullery=-113 sculpture=-169 sculpture_=-83 sculpture_and=-71
    sculptures=-23 sealed=181 search=139 seashells=-71 seat=-200 seat_=-113 seat_on=-94
    seating=-71 seats=-191 seats_=-113 sec=-42 second=-107 second_=-72 second_door=-34
    second_floor=-113 second_left=-113 second_one=-200 second_right=-148 second_set=-113
    second_turn=109 secondly=-42 seconds=181 section=181 sectional=-94 sector=-42 secure=-94
    security=145 see=-157 see_a=-106 see_an=-159 see_if=-94 see_stairs=-94 see_that=-164
    see_the=-200 see_two=-113 seen=-71 segment=-71 select=-94 sells=-42 send=200 sendorfer=-142
    sense=139 sensor=-42 sent=200 sentence=200 sentences=200 separating=-42 separation=-42
    seriously=181 served=181 server=181 serves=-42 service=166 service_=200 serving=-42
    session=181 set=-17 set_of=-200 sets=-128 sets_of=-128 seven=-113 seventh=-71 sewing=-154
    sewing_machine=-154 shade=-94 shade_=-94 shall=186 shaped=-113 shaped_like=-94 sharp=-132
    sharp_left=-200 sharp_right=-200 sharply=-71 she=200 she's=-42 shed=-94 sheets=-42
    shelf=-200 shelf_=-183 shelf_and=-187 shelf_of=-113 shelf_with=-113 shells=-42 shelves=-200
    shelves_=-128 shelving=-42 shhh=-71 shift=-94 shiny=-183 shiny_black=-94 shiny_floor=-113
    ship=-128 ship's=-42 shipping=181 shoe=-200 shoe_display=-113 shoe_rack=-128 shoe_store=-94
    shoes=-164 shoes_=-128 shop=-200 shop_=-142 shop_and=-94 shop_past=-94 shop_turn=-94
    shopping=-113 shopping_carts=-113 short=-200 short_of=-94 should=92 should_be=-41
    should_go=200 should_not=200 should_now=-142 should_see=-200 should_stop=-142 shoulder=181
    shout=-42 shouted=200 shouts=181 shove=-42 show=109 shower=-200 shower_=-113 shower_and=-121
    shower_room=-164 shower_turn=-71 showers=-154 shredder=-42 shut=200 shut_down=200
    shutdown=181 shutters=-71 shy=-42 side=-126 side_=-143 side_and=-200 side_as=-94
    side_chapel=-94 side_door=-164 side_of=-173 side_to=-113 sideboard=-94 sides=74 sign=-73
    sign_=-53 sign_and=-174 sign_with=-113 signal=181 signed=181 signs=-142 sill=-94 sill_=-94
    silly=-42 silver=-94 simple=-71 since=-142 since_the=-128 singing=-42 single=129
    single_step=170 sink=-200 sink_=-200 sink_and=-154 sink_in=-83 sinks=-198 sinks_=-113
    sinks_and=-154 sir=181 sister=-42 sit=-10 sit_down=109 sit_on=-94 site=185 sits=-142
    sitting=-200 sitting_area=-113 six=-200 six_=-94 sixth=-113 sixty=-42 size=-71 skeleton=-164
    skeleton_=-94 ski=-71 skinny=-113 skip=123 skip_the=77 skipped=181 skirt=-113 skirting=181
    skis=-71 skylight=-164 skylight_=-142 sleep=200 sleeping=-42 sleeps=-42 slide=68 slider=-142
    slides=-42 sliding=-200 sliding_door=-198 sliding_doors=-200 sliding_glass=-94 slight=-200
    slight_left=-200 slight_right=-200 slightly=-200 slightly_left=-200 slightly_right=-200
    slip=-94 slope=-42 sloping=-42 slot=-71 slow=-42 slowly=-164 small=-158 small_door=-164
    small_hallway=-94 small_office=-94 small_room=-94 small_table=-187 smalls=-42 smell=-42
    smells=-42 smelly=-42 smidge=-71 smile=-94 smooth=-42 snack=-113 snail=-71 sneak=-71
    snuggled=-42 so=48 so_be=-94 so_do=188 so_find=-113 so_get=-94 so_go=-197 so_it's=-113
    so_just=-191 so_keep=91 so_let's=-94 so_rotate=119 so_stop=7 so_that=-200 so_that's=-94
    so_the=-164 so_turn=17 so_use=119 so_walk=-72 so_you=-67 so_you're=-164 soak=-42 soccer=-42
    socks=-71 sofa=-114 sofa_=-200 sofa_and=-200 sofa_on=-83 sofas=-113 soffit=-42 soft=-113
    software=181 soldier=-71 some=-37 somebody=105 someone=199 someone's=-42 someone_else=200
    something=200 something_=200 sometimes=-42 somewhere=-113 song=-42 soon=0 soon_as=-56
    sooner=-42 sorry=-17 sort=-42 sound=-42 source=-42 spa=-169 spa_=-104 space=53
    space_between=-94 span=-42 speaker=109 speakers=-42 speaking=200 special=181 species=-42
    specifically=-42 speed=139 spiders=-71 spin=179 spin_around=129 spin_on=200 spinning=-94
    spiral=-200 spiral_staircase=-191 splits=-198 spoken=181 sports=-42 spot=59 spot_=46
    spot_a=-94 squad=-71 square=2 square_table=-83 squares=-42 squeaks=-42 squeeze=-128
    squirts=-42 squishy=-42 st=-71 stable=-71 stack=-128 stack_of=-128 stacked=-142 staff=17
    staff_only=-164 stage=-200 stage_=-142 stage_and=-113 stage_up=-94 stain=-71 stained=-113
    stained_glass=-113 stair=-174 stair_=-94 staircase=-167 staircase_=-200 staircase_and=-164
    staircase_on=-94 staircases=-71 stairs=-98 stairs_=-59 stairs_all=-113 stairs_and=-133
    stairs_are=-113 stairs_beside=-94 stairs_but=-113 stairs_down=27 stairs_go=-128
    stairs_going=-94 stairs_next=-164 stairs_not=-128 stairs_on=-128 stairs_take=-142
    stairs_that=39 stairs_then=-174 stairs_to=-200 stairs_turn=-200 stairs_up=-113
    stairs_which=-94 stairs_with=-183 stairway=-200 stairway_=-174 stairway_and=-135
    stairway_on=-83 stairwell=-164 stall=-71 stalls=-71 stand=-5 stand_=58 stand_and=-159
    stand_by=43 stand_in=53 stand_next=-159 stand_still=166 stand_then=-58 stand_turn=-94
    stand_with=-200 standard=-42 standing=-112 standing_in=-200 standing_on=-113 stands=-71
    star=-113 star_=-94 starboard=-113 staring=-42 stars=-71 start=94 start_=200 start_at=-128
    start_by=-200 start_in=-174 start_there=-94 started=200 starting=-14 starting_at=-178
    state=-42 station=-200 station_=-94 station_and=-164 stationary=-42 statue=-200 statue_=-200
    statue_and=-148 statue_of=-191 status=181 stay=198 stay_=200 stay_here=200 stay_in=115
    stay_on=-154 stay_put=200 stay_there=115 stay_where=200 staying=-94 stays=-42 steady=-42
    steam=-142 steam_room=-113 steel=-183 steeply=-42 steering=139 step=-11 step_=46 step_and=63
    step_away=-164 step_inside=-94 step_into=-200 step_of=170 step_out=-74 step_over=-200
    step_stop=-83 step_turn=-128 stepping=-113 steps=-51 steps_=7 steps_and=-200 steps_down=-200
    steps_forward=-142 steps_go=-113 steps_going=-94 steps_into=-113 steps_on=-159
    steps_then=-195 steps_to=-200 steward=-42 stick=-42 sticks=-94 still=165 still_=200
    stinky=-42 stone=-200 stone_bench=-94 stone_floor=-94 stone_stairs=-94 stone_steps=-164
    stones=-71 stool=-200 stool_=-200 stool_and=-128 stool_then=-71 stool_with=-94 stools=-200
    stools_=-183 stools_and=-128 stools_to=-71 stools_turn=-83 stoolss=-23 stop=-137 stop_=-91
    stop_1=-174 stop_a=-174 stop_and=31 stop_as=87 stop_at=-200 stop_before=-109
    stop_behind=-200 stop_beside=-200 stop_between=-200 stop_by=-200 stop_facing=-178
    stop_here=95 stop_in=-200 stop_inside=-198 stop_is=200 stop_just=-200 stop_near=-37
    stop_next=-200 stop_now=200 stop_on=-200 stop_once=-164 stop_outside=-200 stop_right=-200
    stop_there=-200 stop_to=-164 stop_under=-200 stop_when=-133 stop_where=51 stop_with=-154
    stopped=109 stopping=51 stopping_=200 stops=-71 store=-174 store_=-128 storey=-42 story=181
    stove=-200 stove_=-200 stove_and=-187 stove_in=-94 stove_past=-94 straight=-200
    straight_=-72 straight_across=-200 straight_ahead=-200 straight_and=-154
    straight_between=-195 straight_down=-200 straight_into=-164 straight_on=-10
    straight_out=-200 straight_past=-200 straight_then=-83 straight_through=-125
    straight_to=-200 straight_until=-200 straight_with=-94 streamers=-71 street=-142
    stretcher=-42 string=139 stringed=-42 strings=-71 strip=-42 striped=-200 striped_blanket=-94
    striped_rug=-113 strips=-42 stripy=-94 stroll=-128 strollers=-42 stuck=200 student=-71
    studio=-94 studio_=-94 study=-200 study_=-164 study_and=-191 stuff=181 stuffed=-113
    stuffed_bear=-113 subheading=-94 subject=-42 success=200 such=-71 sugar=-42 suit=-154
    suit_of=-154 suitcase=-42 suitcases=-42 summer=-42 sump=-42 sun=-195 sun_room=-159
    sundial=-71 sunflowers=-71 sunken=-113 sunny=-42 sunroom=-183 sunroom_=-94 sunshine=-42
    super=-71 supersedes=181 superstar=-42 supervisor=200 support=181 sure=68 surface=-71
    sushi=-42 suspended=181 swan=-42 swap=200 swap_left=200 swapped=-142 sway=-42 sweep=-42
    sweet=-128 sweet_little=-94 sweetheart=-42 sweetie=-42 swimming=-71 swing=-200 swing's=-42
    swing_=-164 swing_and=-113 swinging=-164 swinging_doors=-128 swings=-42 swingy=-42
    switch=100 switched=181 switches=-142 swivel=-94 sworn=-42 system=200 t=-154 t_=-94
    t_junction=-94 ta=-42 tabel=-142 table=-186 table_=-200 table_and=-200 table_around=-71
    table_at=-94 table_between=-94 table_go=-94 table_head=-58 table_in=-159 table_is=53
    table_keeping=-128 table_on=-200 table_so=-135 table_that=-113 table_then=-200 table_to=17
    table_turn=-121 table_walk=-113 table_where=-128 table_with=-200 tables=-53 tables_=-142
    tables_with=-94 tada=-42 tail=-94 take=-36 take_a=-117 take_about=-94 take_it=-183
    take_one=-128 take_the=-66 take_two=53 take_you=-154 taken=200 takes=-42 taking=-71
    tall=-200 tall_chair=-94 taller=-42 tallest=-71 tan=-195 tan_chair=-58 tank=-200 tank_=-200
    tank_and=-169 tank_then=-83 tape=-154 taped=-42 tapestry=-200 tapestry_=-135
    tapestry_and=-83 tapestrys=-23 target=88 task=200 task_=200 tasking=-42 tastes=-42 tea=-128
    teacher=181 teacher's=-142 teacher's_desk=-142 teal=-71 team=200 technician=200
    technician_with=200 teddies=-71 teenager's=-42 teeny=-128 teh=181 telephone=-113
    telescope=-174 telescope_=-154 television=-200 television_=-200 television_and=-83
    television_then=-58 televisions=-23 tell=200 tell_you=200 teller=-113 telling=181 tells=200
    tells_you=200 telly=-71 tempting=-42 ten=174 tent=-71 term=-42 terminal=-42 terminate=-71
    terminates=-71 terminating=-42 terms=181 terrace=-200 terrace_=-142 terrace_and=-94 test=181
    text=200 text_says=200 text_you=157 than=147 than_the=87 thank=200 thank_you=200 thanks=170
    that=98 that's=-200 that's_a=-142 that's_all=-94 that's_at=-94 that's_closest=-94
    that's_got=-128 that's_it=-154 that's_on=-94 that's_shaped=-94 that's_the=-191
    that's_where=-200 that's_your=-142 that_=151 that_and=-113 that_are=185 that_door=-198
    that_follow=172 that_follows=200 that_go=-113 that_goes=113 that_has=-200 that_is=108
    that_it=59 that_looks=39 that_none=200 that_one=-200 that_robots=200 that_room=170
    that_says=-198 that_the=109 that_was=200 that_way=88 that_you=200 the=-48 the_3=-71
    the_administrator=200 the_aisle=-200 the_alarm=-164 the_alcove=-113 the_altar=-198
    the_aquarium=-154 the_arch=-200 the_archway=-200 the_armchair=-174 the_art=-94 the_atm=-94
    the_attic=-200 the_automatic=-142 the_baby=-142 the_back=-153 the_balcony=-200
    the_ballroom=-183 the_bananas=-94 the_banister=53 the_baptistery=-113 the_bar=-200
    the_barbecue=-142 the_barn=-142 the_barrels=-113 the_base=-94 the_basement=68 the_bath=-94
    the_bathroom=-116 the_bathtub=-200 the_bay=-174 the_bead=-94 the_beaded=-94 the_bed=-166
    the_bedroom=-35 the_beds=-128 the_beginning=200 the_bell=-142 the_bench=-200
    the_bicycle=-142 the_bidet=-94 the_big=-200 the_biggest=-94 the_bike=-113 the_bikes=-113
    the_billiard=-113 the_birdbath=-113 the_black=-187 the_blackboard=-128 the_blue=-200
    the_boiler=-174 the_bookcase=-200 the_bookshelf=-178 the_boot=-94 the_boss=53
    the_bottom=-200 the_brass=-94 the_bread=-94 the_break=-94 the_breakfast=-200 the_brick=-191
    the_bridge=-113 the_brochure=-113 the_brown=-200 the_bucket=-113 the_buffet=-128
    the_building=116 the_bulletin=-113 the_bunk=-200 the_bust=-154 the_cabin=-164
    the_cabinet=-183 the_cactus=-142 the_cafe=-128 the_cake=-94 the_candle=-187 the_candles=-128
    the_candy=-94 the_carpet=-200 the_cash=-198 the_ceiling=100 the_cellar=-164 the_center=-164
    the_cereal=-113 the_chair=29 the_chairs=-200 the_chandelier=-200 the_changing=-154
    the_chapel=-94 the_charging=17 the_chart=-113 the_checkout=-94 the_chess=-113 the_chest=-94
    the_chief=200 the_chimney=-94 the_china=-128 the_christmas=-113 the_church=-128
    the_classroom=-154 the_cloakroom=-94 the_clock=-200 the_closed=-174 the_closest=-128
    the_closet=-116 the_coat=-200 the_coats=-113 the_coffee=-200 the_column=-104 the_columns=-94
    the_computer=-113 the_concierge=-113 the_conference=-200 the_confessional=-113
    the_contrary=200 the_control=109 the_copier=-198 the_corner=-200 the_corridor=-200
    the_costumes=-94 the_couch=67 the_counter=-200 the_courtyard=-154 the_crib=-200
    the_curtain=-200 the_curved=-164 the_dance=-128 the_dark=-94 the_dartboard=-142
    the_deck=-200 the_deep=-113 the_deer=-113 the_den=-183 the_description=200 the_desk=-200
    the_desks=-164 the_dining=-200 the_dinosaur=-128 the_direction=53 the_directions=200
    the_dishwasher=-200 the_display=-142 the_distance=-164 the_doctor's=39 the_dog=-142
    the_door=-138 the_doormat=-174 the_doors=-183 the_doorway=-200 the_double=-200
    the_dresser=-200 the_dressing=-191 the_drinking=-113 the_drum=-174 the_drums=-128
    the_dryer=-174 the_easel=-164 the_edge=-200 the_elevator=-200 the_elevators=-164
    the_end=-105 the_engine=-94 the_entrance=-154 the_entryway=-195 the_escalator=-200
    the_exercise=-159 the_exit=-31 the_eye=-113 the_family=-148 the_far=-200 the_fence=-113
    the_fern=-128 the_fifth=-113 the_filing=-113 the_fire=-11 the_fireplace=-200 the_first=-31
    the_fish=-200 the_five=-94 the_floor=-24 the_flower=-174 the_flowers=-113 the_folding=-94
    the_following=200 the_font=-128 the_foosball=-94 the_foot=-200 the_fountain=-200
    the_four=-159 the_fourth=-10 the_foyer=-106 the_freezer=-164 the_french=-200 the_fridge=-200
    the_front=-124 the_fruit=-94 the_full=-94 the_gallery=-154 the_game=-159 the_gap=-128
    the_garage=-81 the_garden=-17 the_gas=-113 the_gate=-200 the_generator=-94 the_giant=-94
    the_gift=-154 the_glass=-175 the_globe=-200 the_goal=200 the_gold=-128 the_grandfather=-178
    the_grass=-113 the_gray=-195 the_green=-200 the_grey=-174 the_grill=-200 the_guest=-200
    the_guitar=-113 the_gumball=-113 the_gym=-200 the_half=-113 the_hall=-200 the_hallway=-200
    the_handrail=-113 the_harp=-191 the_harpsichord=-113 the_hat=-142 the_hatch=-154 the_hay=-94
    the_head=200 the_heavy=-94 the_hedge=-94 the_high=-174 the_hooks=-94 the_horse=-128
    the_hospital=7 the_hot=-200 the_hotel=-142 the_house=65 the_ice=-200 the_inner=-94
    the_iron=-154 the_ironing=-174 the_island=-183 the_jacuzzi=-135 the_jukebox=-142
    the_keyboard=-94 the_kitchen=-89 the_kitchenette=-113 the_l=-94 the_ladder=-200 the_lady=-94
    the_lamp=-200 the_landing=-200 the_large=-200 the_last=41 the_laundry=-200 the_leather=-200
    the_left=-200 the_leftmost=-94 the_letter=109 the_library=-200 the_life=-154
    the_lifeboat=-94 the_lifeboats=-113 the_lifebuoy=-94 the_lifeguard=-94 the_lift=-2
    the_light=-142 the_linen=-200 the_list=200 the_little=-200 the_living=-60 the_lobby=-200
    the_locker=-94 the_lockers=-200 the_loft=-142 the_long=-123 the_lounge=-200 the_low=-94
    the_lower=-113 the_lunch=-94 the_machine=-183 the_mailbox=-154 the_mailboxes=-174
    the_main=-128 the_mannequin=-142 the_map=200 the_marble=-200 the_massage=-191
    the_master=-154 the_mat=-200 the_metal=-200 the_microwave=-183 the_middle=-126 the_milk=-94
    the_mirror=-200 the_mirrored=-113 the_mirrors=-142 the_mop=-142 the_moving=-128 the_mud=-178
    the_museum=-113 the_music=-128 the_narrow=-154 the_nave=-94 the_nearest=-30
    the_newspapers=-113 the_next=59 the_nightstand=-174 the_notice=-94 the_number=39
    the_nurse's=-174 the_nursery=-200 the_nurses=-128 the_object=200 the_office=-200 the_old=77
    the_one=-41 the_ones=-94 the_open=-200 the_opening=-174 the_opposite=200 the_orange=-191
    the_organ=-128 the_other=71 the_ottoman=-164 the_outside=-128 the_oval=-94 the_oven=-200
    the_owner=200 the_painting=-159 the_pantry=-200 the_passage=-128 the_path=36 the_patio=-200
    the_people=-2 the_person=200 the_pews=-164 the_phone=-154 the_photos=-128 the_piano=-200
    the_picture=22 the_pictures=-94 the_pillar=-198 the_pinball=-113 the_ping=-142 the_pink=-135
    the_place=200 the_plan=200 the_plant=-200 the_plaque=-164 the_playroom=-142 the_plunge=-164
    the_podium=-113 the_police=200 the_pool=-200 the_popcorn=-128 the_porch=-200
    the_portrait=-154 the_poster=77 the_potted=-200 the_pottery=-94 the_pretty=-94
    the_printer=-174 the_pulpit=-142 the_puppet=-113 the_purple=-200 the_rack=-174
    the_radiator=-164 the_rail=-183 the_railing=-200 the_ramp=-200 the_reading=-113
    the_reception=-200 the_record=-113 the_red=-200 the_refrigerator=-200 the_remaining=53
    the_rest=200 the_restaurant=-113 the_reverse=200 the_revolving=-164 the_right=-199
    the_robot=-191 the_rocking=-191 the_roof=-113 the_room=-151 the_rope=-164 the_round=-200
    the_route=200 the_row=-200 the_rowing=-94 the_rows=-94 the_rug=-200 the_run=200
    the_safety=200 the_salad=-94 the_same=-31 the_sandbox=-94 the_sauna=-200 the_scale=-200
    the_school=-94 the_screen=-174 the_scullery=-113 the_sculpture=-113 the_second=-161
    the_sentence=200 the_service=109 the_set=-128 the_sewing=-154 the_shelf=-200
    the_shelves=-128 the_shiny=-142 the_shoe=-200 the_shoes=-128 the_shop=-183 the_shopping=-113
    the_short=-128 the_shower=-200 the_showers=-154 the_side=-200 the_sign=-19 the_sill=-94
    the_silver=-94 the_sink=-200 the_sinks=-154 the_site=185 the_sitting=-113 the_sixth=-113
    the_skeleton=-94 the_skylight=-142 the_sliding=-200 the_small=-200 the_snack=-94
    the_sofa=-30 the_spa=-159 the_space=-94 the_speaker=109 the_spiral=-200 the_spot=188
    the_square=-83 the_stack=-113 the_stacked=-128 the_stage=-200 the_stained=-113
    the_staircase=-200 the_stairs=-85 the_stairway=-200 the_start=200 the_statue=-200
    the_steam=-142 the_steel=-113 the_steps=-136 the_stone=-200 the_stool=-169 the_stools=-113
    the_stop=200 the_store=-94 the_stove=-200 the_striped=-200 the_study=-200 the_suit=-142
    the_sun=-187 the_sunken=-94 the_sunroom=-164 the_supervisor=200 the_swing=-200
    the_swinging=-154 the_t=-154 the_table=-43 the_tables=-142 the_tall=-200 the_tan=-148
    the_tape=-94 the_tapestry=-135 the_task=200 the_tea=-113 the_teacher's=-142
    the_telephone=-94 the_telescope=-174 the_television=-195 the_terrace=-191 the_text=200
    the_theater=-191 the_third=-170 the_three=-200 the_threshold=-198 the_throne=-164
    the_ticket=-183 the_tile=-128 the_tiles=-113 the_tiny=-128 the_toilet=-34 the_toilets=-94
    the_top=-200 the_towel=-183 the_towels=-113 the_tower=-113 the_toy=-142 the_trash=-148
    the_treadmill=-200 the_treadmills=-142 the_tree=-174 the_trip=200 the_trophies=-94
    the_trophy=-174 the_trunk=-113 the_tub=-200 the_turns=200 the_turnstile=-154 the_tv=-200
    the_two=-135 the_typewriter=-94 the_umbrella=-200 the_unit=200 the_user=200 the_utility=-148
    the_vacuum=-113 the_vanity=-191 the_vase=-200 the_velvet=-94 the_vending=-200 the_very=17
    the_vestibule=-94 the_volcano=-94 the_waiting=-121 the_walk=200 the_wall=-57 the_walls=68
    the_wardrobe=-200 the_washer=-159 the_washing=-200 the_water=-200 the_way=-3 the_weight=-128
    the_well=-128 the_whale=-94 the_wheelchair=-94 the_while=196 the_white=-200
    the_whiteboard=-200 the_whole=132 the_wicker=-195 the_wigs=-113 the_window=-200
    the_windows=-164 the_wine=-200 the_wobbly=-94 the_wood=-94 the_wooden=-200 the_word=166
    the_words=200 the_workbench=-142 the_wrong=200 the_yard=-142 the_yellow=-200 theater=-200
    theater_room=-154 theater_with=-94 theatre=-94 their=185 them=-47 them_=-34 them_all=109
    them_and=-183 them_on=-128 them_to=-154 themselves=-71 then=-200 then_a=-183 then_after=-83
    then_another=-113 then_as=-83 then_at=-142 then_bear=-104 then_climb=-104 then_come=-113
    then_continue=-121 then_cross=-200 then_descend=-121 then_down=-94 then_enter=-142
    then_follow=-195 then_go=-200 then_hang=-113 then_head=-174 then_immediately=-113
    then_in=-94 then_it's=-191 then_keep=-174 then_left=-200 then_look=-94 then_make=-104
    then_move=-121 then_once=-121 then_out=-183 then_pass=-200 then_past=-200 then_proceed=-164
    then_right=-200 then_slightly=-94 then_stand=-71 then_step=-159 then_stop=-200
    then_straight=-94 then_take=-200 then_that=-94 then_the=-154 then_there's=-183
    then_through=-128 then_to=-113 then_turn=-200 then_up=-113 then_veer=-71 then_wait=-200
    then_walk=-200 then_when=-121 then_you=-200 then_you'll=-128 then_you're=-164 there=-52
    there'll=-113 there'll_be=-113 there's=-200 there's_a=-200 there's_the=-183 there_=-64
    there_and=-59 there_are=-46 there_but=-94 there_is=16 there_make=-94 there_should=-174
    there_so=-128 there_take=-94 there_turn=-113 there_will=-198 there_without=-94 there_you=-94
    thereafter=-42 thereof=-42 theres=-42 these=200 these_commands=200 they=200 they're=-183
    they've=-71 they_are=200 they_turn=-94 they_were=200 thick=-42 thin=-94 thing=-11 thing_=-94
    thing_is=27 thing_number=-94 thing_you=27 things=200 think=137 think_of=170 third=-187
    third_=-191 third_desk=-94 third_door=-24 third_right=-104 third_row=-142 third_window=-142
    thirdly=-42 this=200 this_=200 this_at=200 this_building=200 this_house=200 this_is=200
    this_one=36 this_room=17 this_route=200 this_run=200 this_says=200 this_step=129
    this_task=200 this_text=200 those=-200 those_and=-94 though=-128 three=-126 three_=-128
    three_doors=-183 three_is=-94 three_o'clock=-94 three_stairs=-148 three_stairway=-58
    three_steps=-200 threshold=-198 threshold_and=-198 throne=-191 throne_=-113 throne_and=-128
    through=-200 through_=-183 through_90=-94 through_a=-94 through_and=-154 through_door=-94
    through_it=-80 through_that=-191 through_the=-200 through_there=-94 throughout=139 throw=200
    thru=-94 thumping=-42 tick=-42 ticked=181 ticket=-200 ticket_booth=-113 ticket_machine=-113
    ticks=-42 tied=-71 tiger=-71 tight=-94 tile=-200 tiled=-71 tiles=-183 tiles_=-128 till=-200
    till_the=-200 till_you=-200 time=178 time_and=-113 time_you=200 times=142 times_=200
    tinsel=-71 tiny=-200 tiny_bit=-94 tiny_chairs=-94 tiptoe=-94 titchy=-42 to=-14 to_a=-200
    to_an=-164 to_be=200 to_begin=-94 to_carry=200 to_disregard=200 to_do=102 to_drop=140
    to_end=200 to_face=-200 to_find=113 to_follow=200 to_gate=-113 to_get=-198 to_go=90
    to_it=-149 to_its=-23 to_keep=-113 to_leave=200 to_look=-198 to_move=200 to_open=-142
    to_pass=-142 to_read=157 to_return=200 to_say=-94 to_see=-94 to_stand=-94 to_stop=116
    to_take=121 to_tell=200 to_that=-128 to_the=-117 to_turn=-48 to_undo=119 to_wait=109
    to_walk=192 to_where=160 to_you=200 to_your=-68 tock=-42 today=200 today's=-154 today_=200
    toddle=-71 todo=181 toes=-71 together=-113 toilet=-57 toilet_=59 toilet_ahead=-58
    toilet_and=-200 toilets=-94 told=200 told_me=200 told_to=200 tolerance=-42 tomatoes=-71
    tomb=-71 tomorrow=181 too=80 too_=125 took=-42 tool=-94 tool_bench=-94 toolbox=-42 tools=-71
    top=-200 top_=-200 top_and=7 top_go=-94 top_of=-200 top_turn=-113 top_you'll=-94 toss=181
    touch=-154 touch_the=-113 touching=181 toward=-200 toward_the=-200 towards=-131
    towards_it=-94 towards_the=-188 towel=-200 towel_=-113 towel_rack=-191 towels=-191
    towels_=-174 tower=-164 toy=-198 toy_chest=-113 toys=-113 trace=181 track=-94 tractor=-94
    tractor_=-94 trade=181 train=-128 trains=-71 trajectory=-42 trampoline=-71 transition=-42
    translate=-42 translating=181 translation=-71 trap=200 trash=-198 trash_can=-198 travel=147
    travels=-42 traverse=-94 tray=-42 tread=-42 treadmill=-200 treadmill_=-198
    treadmill_and=-113 treadmill_turn=-58 treadmills=-164 treadmills_=-94 treads=-113
    treasure=-42 treat=200 treat_all=200 treat_the=200 tree=-200 tree_=-198 tree_and=-113
    treehouse=-71 trees=-71 trestle=-71 trip=200 trolley=-42 trolleys=-71 trophies=-128
    trophies_=-94 trophy=-191 trophy_cabinet=-113 trophy_case=-154 trot=-42 trotting=-42
    trough=-71 trucks=-42 true=181 trun=-142 trunk=-113 trust=200 try=-94 tub=-200 tub_=-200
    tub_and=-142 tub_to=-83 tucked=-42 tulips=-71 tumble=-42 tummy=-42 tune=-71 tuner=-42
    tunr=181 turn=-82 turn_=106 turn_90=-200 turn_and=53 turn_around=-41 turn_at=-142
    turn_away=100 turn_back=200 turn_go=109 turn_into=-128 turn_is=200 turn_left=-200
    turn_right=-169 turn_round=17 turn_sharp=-198 turn_slightly=-200 turn_so=-94 turn_to=-200
    turn_toward=-94 turn_until=-94 turn_your=-200 turned=-42 turning=39 turning_on=157 turns=200
    turns_=200 turnstile=-183 turnstile_=-113 turnstile_and=-94 turnstiles=-71 tv=-200 tv_=-200
    tv_and=-142 twang=-42 twelve=-198 twelve_=-94 twice=116 twice_=109 twice_without=185
    twin=-71 twirl=200 twirl_in=200 twist=-42 twit=-42 two=-114 two_=113 two_beds=-94
    two_bookshelves=-94 two_computer=-113 two_couches=-94 two_doors=-200 two_flights=-164
    two_floors=-142 two_hallways=-94 two_long=-113 two_paintings=-94 two_pillars=-113
    two_rooms=-142 two_rows=-113 two_sinks=-113 two_steps=-22 two_three=-94 type=-71 typed=181
    typewriter=-113 typewriter_=-94 typing=139 u=-200 u_turn=-200 uh=-142 um=-164 umbrella=-200
    umbrella_=-94 umbrella_stand=-200 under=-64 under_it=-164 under_the=-196 underneath=68
    understand=181 understood=181 undo=200 undo_what=200 unicorn=-71 uniform=-42 unit=200
    unit_shall=200 units=200 unless=181 unlit=-42 unspecified=-42 until=-24 until_=88
    until_it=-191 until_the=-11 until_you=-102 until_you're=-183 unusual=-42 up=-110 up_=32
    up_a=-142 up_all=-200 up_and=-31 up_at=-94 up_both=-142 up_by=-94 up_in=17 up_it=-128
    up_one=-200 up_or=68 up_the=-200 up_them=-198 up_there=170 up_those=-113 up_three=-200
    up_to=-200 up_two=-200 up_with=87 update=200 updated=181 upholstery=-42 upon=-42 upper=-42
    ups=-71 upside=139 upstairs=30 upstairs_=113 upstairs_in=-113 upwards=-42 urer=181 urn=-71
    us=88 us_=-94 use=106 use_the=63 used=68 used_to=-94 user=200 user's=181 using=-187
    using_the=-187 usually=-42 utility=-148 utility_room=-148 vacuum=-183 vacuum_cleaner=-128
    valid=200 van=-42 vanity=-200 vanity_=-71 vanity_and=-135 vanitys=-23 vase=-200 vase_=-195
    vase_of=-94 vase_on=-135 vases=-164 vault=-113 vector=-42 veer=-200 veer_a=-94
    veer_left=-142 veer_right=-104 veering=-42 vegetables=-42 vehicle=-42 velocity=-42
    velvet=-94 velvet_rope=-94 vending=-200 vending_machine=-200 veranda=-71 verb=200
    verification=-42 version=181 vertical=-71 very=-37 very_first=109 vessel's=-42 vestibule=-94
    vestry=-71 vests=-42 via=-191 via_the=-154 view=-174 view_=-94 vineyard=-42 vise=-71
    visit=-94 visually=-42 voice=200 void=200 void_=200 void_so=119 voids=181 volcano=-94
    voted=181 w=-142 waffle=-71 waist=-42 wait=-46 wait_=-22 wait_at=-200 wait_beside=-154
    wait_by=-117 wait_for=167 wait_here=96 wait_in=-200 wait_just=-178 wait_near=-187
    wait_next=-200 wait_outside=115 wait_there=-200 wait_under=-164 waiting=-34
    waiting_area=-135 waiting_room=-94 wake=-42 wakes=181 walk=-126 walk_=200 walk_3=-113
    walk_a=-159 walk_across=-200 walk_ahead=-164 walk_all=-142 walk_along=-168
    walk_alongside=-200 walk_around=-200 walk_away=-17 walk_back=185 walk_behind=-94
    walk_beside=-94 walk_between=-200 walk_by=-200 walk_down=-200 walk_forward=-200
    walk_from=-142 walk_in=19 walk_inside=-200 walk_into=-67 walk_on=-200 walk_out=-132
    walk_over=-128 walk_past=-200 walk_round=-94 walk_straight=-200 walk_the=-10
    walk_through=-200 walk_to=-138 walk_toward=-174 walk_towards=-69 walk_under=-200
    walk_until=-200 walk_up=-200 walked=139 walking=13 walking_=53 walking_past=-200 walks=200
    walkway=-191 walkway_to=-113 wall=-57 wall_=-124 wall_and=-48 wall_ends=-94 wall_of=87
    wall_on=-43 wall_past=-113 wall_that=109 wall_that's=-94 wall_to=39 wall_with=-183
    wallpaper=-94 walls=-6 walls_=43 walls_and=-113 walnut=-42 wander=68 want=-68 want_=-154
    want_the=-200 want_to=-200 want_you=67 wanted=109 wants=200 wants_you=200 ward=87
    wardrobe=-200 wardrobe_=-200 wardrobe_and=-104 warm=-94 warmer=-71 warn=-42 warranty=181
    was=200 wash=-94 washer=-200 washer_=-135 washer_and=-104 washing=-200 washing_machine=-200
    washing_machines=-83 wasn't=-42 wasteful=-42 watch=-164 watches=-42 watching=-42 water=-200
    water_cooler=-200 water_fountain=-174 water_heater=-128 wave=-154 waxed=-42 way=54 way_=141
    way_around=-113 way_down=-198 way_into=-94 way_of=-195 way_out=-128 way_over=-94
    way_round=200 way_through=-94 way_to=-65 way_up=-94 way_you=100 waypoint=129 we=93 we'd=-42
    we'll=-164 we're=-17 we're_going=-128 we're_not=87 we've=87 we_can=-94 wearing=-42 weave=-42
    weaving=-42 wedding=-71 wedge=-42 wee=-71 weighing=-71 weight=-142 weight_bench=-94
    weight_rack=-94 weights=-71 welcome=-128 welcoming=-42 well=30 well_=-142 wellies=-71
    went=-174 were=200 were_mirrored=200 western=-42 westward=-42 wet=87 whale=-113 what=200
    what_=185 what_is=200 what_it=200 what_the=200 what_they=200 what_this=200 what_you=200
    whatever=200 whatever_is=200 wheee=-42 wheel=53 wheel_=87 wheelbarrow=-71 wheelchair=-94
    wheelchairs=-113 wheels=137 wheels_=53 when=-115 when_the=-10 when_you=-128 when_you're=-200
    when_you've=-113 whenever=200 whenever_you=200 where=86 where_a=170 where_it=181
    where_people=-128 where_the=-200 where_there's=-94 where_they=178 where_you=167
    where_you'll=-94 wherever=200 wherever_it=200 which=-33 which_has=-128 which_is=-200
    which_you=147 whichever=-113 while=200 while_=185 whirl=181 whisky=-42 whispered=181
    white=-200 white_door=-183 white_tiles=-113 white_towels=-113 whiteboard=-200
    whiteboard_=-174 whiteboard_turn=-94 whizz=-71 who=200 whoa=-42 whoever=200 whole=95
    whom=181 whoopsie=-42 whopping=-42 whose=-71 why=-42 wicker=-200 wicker_bench=-83 wide=-71
    wider=-142 width=139 wigs=-113 will=-58 will_be=-57 will_see=-200 willow=-71 win=-71
    winch=-71 winders=-42 window=-200 window's=-42 window_=-200 window_and=-54 window_at=-128
    window_in=-121 window_is=-128 window_seat=-164 window_then=-94 window_turn=-121
    window_with=-94 windows=-200 windows_=-198 windows_and=-94 windows_on=-128 windowsill=-42
    wine=-200 wine_cellar=-154 wine_fridge=-113 wine_rack=-200 wing=-42 wink=-71 winner=-42
    wipe=181 wishing=-71 with=-109 with_a=-198 with_all=-128 with_an=-113 with_flowers=-94
    with_full=185 with_glass=-128 with_green=-94 with_it=87 with_lots=-142 with_no=-113
    with_round=-113 with_the=-122 with_three=-128 with_two=-200 with_windows=-113 with_your=0
    withdrawn=200 withdrawn_this=140 within=77 without=-6 without_entering=-164
    without_going=-174 without_moving=185 without_stopping=109 witness=-71 wlak=-142 wobbly=-113
    woke=181 woman=-113 women=-42 won't=-42 wonderful=-42 wood=-200 wood_stove=-128 wooden=-200
    wooden_bench=-94 wooden_door=-200 wooden_floor=-191 wooden_pews=-113 wooden_stairs=-94
    wooden_table=-142 word=200 words=200 work=181 workbench=-154 workbench_=-94 working=-71
    workshop=-71 worry=-71 would=88 would_you=-142 wouldn't=-42 wow=-71 wreath=-113
    wristwatch=-42 write=181 written=200 written_=200 written_next=200 wrong=200 wrong_way=200
    wrote=200 x=185 xylophone=-71 yard=-142 yard_=-113 yaw=109 years=-42 yell=-42 yellow=-200
    yellow_line=-142 yellow_lines=-94 yep=-42 yes=-71 yet=-71 yew=-42 yo=181 yoga=-71 yonder=-42
    you=60 you'd=-71 you'll=-200 you'll_be=-200 you'll_come=-191 you'll_find=-191 you'll_go=-94
    you'll_notice=-94 you'll_pass=-164 you'll_see=-200 you'll_spot=-94 you'll_stop=-94
    you'll_want=-183 you're=-200 you're_at=-200 you're_done=-183 you're_facing=-128
    you're_going=-200 you're_in=-200 you're_looking=-174 you're_not=87 you're_out=-94
    you're_outside=-113 you're_standing=-183 you're_there=-183 you've=-53 you've_gone=-142
    you've_got=-128 you_=72 you_and=3 you_are=95 you_at=-113 you_began=200 you_begin=113
    you_bump=-128 you_came=27 you_can=-43 you_can't=-31 you_come=-94 you_did=200 you_do=200
    you_don't=-174 you_enter=-169 you_find=-113 you_for=200 you_get=-150 you_go=-164
    you_have=127 you_hit=68 you_hold=109 you_in=-113 you_into=-94 you_is=109 you_just=-2
    you_leave=129 you_make=109 you_may=53 you_might=-113 you_must=200 you_need=50 you_out=87
    you_pass=19 you_please=-94 you_reach=-184 you_read=200 you_see=-73 you_shall=-94
    you_should=69 you_so=170 you_stand=154 you_stop=-200 you_take=-174 you_that=200 you_the=200
    you_then=-83 you_to=200 you_turn=60 you_undo=119 you_up=170 you_wait=-113 you_walk=-6
    you_want=-200 you_were=200 you_will=-200 your=20 your_back=-200 your_destination=-142
    your_developer=200 your_feet=-94 your_head=87 your_left=-200 your_mission=109
    your_operator=200 your_orders=200 your_own=200 your_right=-200 your_second=-94 your_steps=45
    your_stop=-94 your_stopping=-142 your_way=-200 your_wheels=200 yours=68 yourself=27
    yourself_and=-94 yourself_at=-94 yourself_in=-113 yummy=-42 zero=68 zone=-142
    """
)
WORDS = {term: int(odds) / 100 for term, odds in (w.split("=") for w in _WORDS)}
