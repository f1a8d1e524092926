"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -0.463,
    "orders": 0.474,
    "text": 0.700,
    "annul": 0.352,
    "invert": 0.009,
    "case": 0.524,
    "halt": 0.381,
    "machine": 0.334,
    "role": 0.288,
    "authority": 0.554,
    "haste": -0.066,
    "if": 0.033,
    "me": -0.516,
    "you": -0.001,
    "third": 0.157,
    "past": 0.036,
    "not": -0.046,
    "here": 0.035,
    "time": 0.137,
    "go": 0.150,
    "has orders": 0.402,
    "has text": 0.173,
    "has annul": 0.379,
    "has invert": 0.172,
    "has case": 1.158,
    "has halt": -0.012,
    "has machine": 0.286,
    "has role": 0.318,
    "has authority": 0.532,
    "has haste": -0.062,
    "has if": 0.257,
    "has me": -0.042,
    "has you": -0.288,
    "has third": 0.092,
    "has past": 0.248,
    "has not": -0.020,
    "has here": -0.323,
    "has time": 0.154,
    "has go": 0.478,
    "hidden": 1.452,
    "alike": 2.670,
    "wide": 1.219,
    "spelled": 2.242,
    "leet": 2.271,
    "code": 0.364,
    "cipher": 1.884,
    "unknown": 0.145,
    "alien": 0.048,
    "foreign letters": 0.232,
    "late verb": 0.110,
    "no verb": 0.207,
    "on route": -0.091,
    "other things": 0.153,
    "nothing": 0.170,
    "turns": 0.028,
    "places": -0.064,
    "no place": 0.723,
    "length": 0.416,
    "short": -0.671,
    "commas": -0.700,
    "asks": -0.101,
    "exclaims": 0.072,
    "quoted": 1.220,
    "quote in": -0.194,
    "markup": 3.072,
    "role of": -0.174,
    "reported": 0.128,
    "self": 0.293,
    "about": 1.092,
    "back to text": -0.386,
    "elsewhere": 0.015,
    "annul orders": 0.225,
    "invert orders": 0.849,
    "case orders": -0.073,
    "not orders": 0.003,
    "halt nowhere": -0.366,
    "halt here": 0.333,
    "not go": -0.012,
    "both sides": 0.763,
    "case not": -0.229,
    "case go": 0.515,
    "case halt": 0.203,
    "me past": 0.198,
    "third past": -0.202,
    "you role": 0.107,
    "authority said": 0.300,
    "machine you": 0.405,
    "me no place": 0.148,
    "past no you": 0.062,
    "annul place": -0.032,
    "not place": 0.436,
    "if place": -0.483,
    "words": 0.940,
    "pairs": 0.601,
    "worst words": -0.010,
    "best words": 0.675,
}
CONTEXT: dict[str, float] = {
    "bias": 0.669,
    "own": 0.902,
    "first": -0.800,
    "last": -0.049,
    "stops early": 1.283,
    "stops before all": 0.330,
    "denies the rest": -0.488,
    "repeats the rest": -0.235,
    "neighbour": 1.110,
    "neighbours": 1.571,
    "alone": -1.261,
    "most": -1.664,
}
PART: dict[str, float] = {
    "bias": -0.742,
    "whole": -0.004,
    "orders": 0.020,
    "text": 0.236,
    "annul": 0.452,
    "invert": 0.158,
    "case": 0.381,
    "halt": 0.500,
    "machine": 0.433,
    "role": 0.199,
    "authority": 0.729,
    "haste": 0.044,
    "if": -0.201,
    "me": -0.649,
    "you": -0.199,
    "third": 0.030,
    "past": 0.071,
    "not": -0.351,
    "here": -0.028,
    "time": 0.035,
    "go": 0.358,
    "has orders": -0.081,
    "has text": 0.408,
    "has annul": 0.445,
    "has invert": 0.158,
    "has case": 0.487,
    "has halt": 0.312,
    "has machine": 0.433,
    "has role": 0.199,
    "has authority": 0.729,
    "has haste": 0.044,
    "has if": 0.100,
    "has me": -0.527,
    "has you": -0.399,
    "has third": 0.184,
    "has past": 0.070,
    "has not": -0.210,
    "has here": -0.596,
    "has time": 0.058,
    "has go": -0.219,
    "hidden": 2.100,
    "alike": 3.671,
    "wide": 0.000,
    "spelled": 0.696,
    "leet": 3.217,
    "code": 0.000,
    "cipher": 2.461,
    "unknown": 1.054,
    "alien": 0.424,
    "foreign letters": 0.326,
    "late verb": -0.029,
    "no verb": -0.729,
    "on route": 0.150,
    "other things": -0.195,
    "nothing": 0.323,
    "turns": 0.434,
    "places": 0.063,
    "no place": -0.123,
    "length": -0.235,
    "short": -0.330,
    "commas": 1.562,
    "asks": -0.762,
    "exclaims": -0.576,
    "quoted": 0.725,
    "quote in": 2.034,
    "markup": 0.000,
    "role of": -0.112,
    "reported": 0.384,
    "self": -0.177,
    "about": 0.313,
    "back to text": -0.348,
    "elsewhere": 0.967,
    "annul orders": 0.687,
    "invert orders": 0.795,
    "case orders": 0.175,
    "not orders": 0.374,
    "halt nowhere": 0.523,
    "halt here": 0.109,
    "not go": 0.429,
    "both sides": 1.021,
    "case not": 0.110,
    "case go": 0.253,
    "case halt": 0.055,
    "me past": -0.118,
    "third past": 0.172,
    "you role": -0.158,
    "authority said": 0.290,
    "machine you": 0.360,
    "me no place": -0.564,
    "past no you": -0.100,
    "annul place": 0.229,
    "not place": 0.355,
    "if place": -0.050,
    "words": 1.401,
    "pairs": 1.007,
    "worst words": -0.096,
    "best words": -0.531,
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
    0=99 07=180 1=-200 10=-142 12=-38 120=-42 13=180 135=-42 14=-42 15=-42 16=-42 18=-42
    180=-164 180_degrees=-164 1_m=-113 2=-200 20=-71 204=-142 214=-71 270=-42 2_m=-198
    2_meters=-113 2_nd=-94 3=-200 30=-94 306=-71 308=-42 310=-42 3_5=-164 3_is=-94 3_m=-94
    3_meters=-113 3_step=-71 4=7 408=-42 45=-71 4_=-128 4_m=-174 4_stop=-142 5=-200 5_m=-113
    5_meters=-113 6=-94 64=180 7=-113 7741=180 8=-42 9=-154 90=-200 90_degrees=-200 9_m=-113
    _=200 _1=-142 _2=-94 _3=-142 _4=-94 _a=112 _action=199 _actually=128 _advance=-128 _after=18
    _all=200 _always=200 _and=-140 _anyway=-113 _as=173 _ascend=-94 _assistant=200 _at=-71
    _back=-198 _bear=-200 _bedroom=-94 _before=60 _begin=-7 _behind=-113 _between=38 _beyond=-94
    _bottom=-113 _bound=-94 _bullet=-94 _but=86 _by=200 _cancel=200 _climb=-200 _come=-200
    _consider=199 _continue=-78 _could=6 _count=-94 _cross=-200 _descend=-148 _disregard=164
    _do=122 _don't=2 _door=-164 _down=-11 _each=196 _end=58 _enter=-200 _every=179
    _everything=166 _exit=-200 _face=-80 _facing=-200 _find=-200 _first=-164 _follow=-117
    _for=200 _forget=123 _from=-14 _front=86 _get=-187 _go=-194 _good=109 _hallway=-94 _halt=98
    _hang=-113 _he=99 _head=16 _heading=-113 _here=-198 _hey=128 _hold=11 _i=149 _i'd=109
    _i'm=-94 _if=116 _ignore=130 _imagine=109 _in=51 _inside=-113 _instead=-200 _into=-113
    _it=123 _it'll=-113 _it's=55 _job=-113 _just=45 _keep=-79 _kindly=200 _ladder=-94 _lap=-94
    _leave=-178 _left=-19 _leg=-142 _let's=-54 _line=-128 _locate=-113 _look=-200 _make=-143
    _message=200 _move=-200 _my=139 _never=200 _new=200 _next=-200 _no=167 _not=-49 _nothing=200
    _notice=200 _now=-200 _objective=-94 _of=-94 _off=-94 _okay=-200 _on=-113 _once=-19
    _one=-154 _only=163 _open=-94 _out=-200 _override=99 _par=-113 _pass=-200 _past=-200
    _perform=199 _phase=-142 _plan=-94 _please=200 _proceed=-200 _quick=-94 _read=200
    _remain=128 _remember=200 _return=128 _reverse=-11 _right=-200 _rotate=-94 _route=-164
    _second=-174 _see=-183 _sharp=-94 _sit=109 _skip=104 _slide=109 _so=-200 _spin=52
    _stage=-113 _stairs=-164 _stand=-61 _start=-200 _starting=-178 _stay=136 _step=-200
    _stop=-168 _straight=-200 _swap=200 _swing=-94 _switch=99 _system=200 _take=-81 _task=200
    _thank=200 _that=125 _that's=-200 _the=142 _then=-200 _there=-2 _there'll=-94 _there's=-200
    _they=114 _thing=-94 _third=-128 _this=200 _three=-128 _through=-128 _to=-18 _train=-94
    _treat=200 _turn=-136 _two=-200 _under=200 _until=200 _up=-200 _use=-183 _user=200
    _veer=-183 _wait=-79 _walk=-200 _we=123 _we'll=-128 _we're=-128 _we've=109 _what=169
    _whatever=200 _when=-53 _whenever=188 _where=96 _with=-68 _without=-191 _x=200 _you=11
    _you'll=-200 _you're=-200 _your=127 a=-50 a_balcony=-83 a_bathroom=-195 a_bathtub=-113
    a_bed=-200 a_bedroom=-113 a_bench=-148 a_big=-200 a_bit=-128 a_black=-159 a_blue=-164
    a_bookcase=-142 a_bookshelf=-94 a_bowl=-113 a_brown=-142 a_bunch=-94 a_cabinet=-71 a_cat=109
    a_chair=14 a_chapel=-94 a_circle=182 a_closed=-94 a_closet=-121 a_comfy=-94 a_couch=27
    a_couple=-198 a_cross=-94 a_curtain=-104 a_cushion=-174 a_desk=-200 a_dining=-104 a_dog=-94
    a_door=49 a_doorway=-142 a_dresser=-83 a_few=2 a_fireplace=-148 a_fish=-135 a_floor=-128
    a_fork=-164 a_friendly=-94 a_gift=-94 a_glass=-195 a_good=86 a_gray=-104 a_green=-164
    a_grey=-58 a_half=-183 a_hall=-128 a_hallway=-89 a_hard=-142 a_hat=-94 a_horse=-154
    a_huge=-94 a_kitchen=-154 a_ladder=-142 a_lamp=-200 a_large=-183 a_laundry=-104 a_left=-158
    a_lion=-113 a_little=-200 a_lobby=-94 a_long=-200 a_lot=-94 a_marble=-94 a_metal=-71
    a_microwave=-94 a_mirror=20 a_narrow=-113 a_nice=-128 a_nursery=-94 a_phone=-94 a_piano=-128
    a_picture=-164 a_pillar=-94 a_pink=-94 a_plant=-198 a_pool=-104 a_popcorn=-113 a_potted=-113
    a_pretty=-94 a_purple=-128 a_quick=-94 a_railing=-113 a_red=-200 a_refrigerator=-113
    a_right=-145 a_road=-94 a_robot=52 a_rocking=-94 a_room=23 a_round=-178 a_row=-142 a_rug=-94
    a_seat=-164 a_set=-121 a_sharp=-200 a_shelf=-121 a_shiny=-113 a_ship=-94 a_short=-94
    a_sign=38 a_sink=-198 a_slight=-200 a_small=-191 a_sofa=-164 a_square=-148 a_staircase=52
    a_stand=-94 a_stone=-142 a_stool=-94 a_stop=-80 a_straight=-94 a_striped=-128 a_sweet=-113
    a_table=-200 a_tall=-113 a_tan=-121 a_tapestry=-71 a_technician=200 a_teeny=-113
    a_television=-178 a_tiny=-128 a_toilet=-142 a_towel=-121 a_trash=-83 a_turn=-128 a_tv=-94
    a_u=-200 a_vase=-94 a_waiting=-94 a_wall=23 a_white=-121 a_whole=-94 a_wicker=-71
    a_window=-200 a_wood=-113 a_wooden=-148 a_yellow=-121 abandon=38 abeam=-42 able=-42
    abort=180 about=163 about_the=200 about_to=200 about_turn=-94 above=200 absolutely=-42
    abutment=-42 access=200 accident=180 accommodation=-42 accomplished=-142 according=180
    accordingly=200 accordingly_=200 accounting=-42 accounts=-42 acquire=-71 across=-200
    across_it=-164 across_the=-200 act=185 acting=200 action=200 action_stop=199 actual=-42
    actually=128 add=138 addressee=180 adjacent=-42 adjustment=-42 admin=180 administrator=200
    administrator's=-142 administrator_has=200 admire=-42 admiring=-42 adn=180 adorable=-42
    advance=-183 advance_to=-154 afford=-42 aft=-94 after=20 after_each=200 after_every=200
    after_it=-198 after_that=-191 after_the=-200 after_this=128 again=-12 again_=83 again_and=68
    again_around=-94 again_at=-200 against=147 against_the=147 agent=180 ago=-42 agree=180
    agreed=180 ahead=-190 ahead_=-200 ahead_and=-164 ahead_of=-200 ahead_to=-113 ahhh=-42
    aid=-142 aim=-42 airlock=-42 aisle=-200 aisle_=-164 aisle_and=-128 aisle_between=-183
    aisle_to=-94 alarm=-198 alcove=-154 alcove_on=-94 alighting=-42 align=-42 all=136 all_=200
    all_around=-142 all_of=133 all_robots=200 all_that=200 all_the=-63 all_turns=200 all_you=109
    alley=-42 allow=200 allow_what=200 allowed=128 almost=-42 along=-139 along_it=-164
    along_that=-94 along_the=-149 along_to=-113 along_until=-94 alongside=-200
    alongside_the=-200 alpha=-71 already=200 already_=200 alright=-42 alrighty=-42 also=-113
    altar=-200 altar_=-113 alter=-42 alters=-42 always=192 always_do=200 always_use=119 am=200
    am_the=200 amble=-42 an=10 an_elevator=-113 an_office=-154 an_open=6 an_orange=-71
    an_oval=-71 an_oven=-71 an_umbrella=-94 ancelledcay=180 anchor=-71 and=-90 and_=173
    and_a=-200 and_after=-183 and_around=-113 and_as=-128 and_at=-200 and_back=169 and_bear=-83
    and_between=-94 and_carry=-191 and_climb=-169 and_come=23 and_continue=-198 and_cross=-164
    and_do=199 and_don't=-191 and_down=-63 and_enter=-200 and_exit=-154 and_face=86
    and_find=-191 and_finish=199 and_follow=-200 and_get=-128 and_give=-94 and_go=-138
    and_halt=-200 and_hang=-187 and_head=-200 and_hold=-142 and_i'll=-94 and_into=-200
    and_it=-142 and_it's=-200 and_just=-128 and_keep=-200 and_leave=42 and_left=-183
    and_look=-174 and_make=-200 and_move=-94 and_no=-128 and_not=86 and_on=-154 and_once=-104
    and_out=-123 and_pass=-200 and_past=-80 and_proceed=-58 and_put=-94 and_report=200
    and_right=185 and_round=52 and_say=-113 and_second=-113 and_stand=72 and_stay=180
    and_step=-178 and_stop=-200 and_straight=-174 and_take=-113 and_that=6 and_that's=-198
    and_the=-111 and_then=-200 and_there=-113 and_there's=-200 and_through=-200 and_to=-94
    and_toward=-200 and_turn=-200 and_two=-154 and_up=-200 and_veer=-113 and_wait=-86
    and_walk=-197 and_when=-200 and_white=-128 and_you=-64 and_you'll=-200 and_you're=-183
    angel=-42 angle=-154 annotator=180 announces=180 another=121 another_door=-94 answer=180
    anticlockwise=-42 any=200 any_further=200 any_more=193 any_of=200 anyhow=-42 anyone=200
    anything=185 anytime=180 anyway=-128 anywhere=200 anywhere_=200 anywho=-42 apart=-42
    apartment=-71 aperture=-71 appearance=-42 appears=180 apples=-113 applies=180 apply=109
    apply_a=109 approach=147 approved=200 approximately=-71 aquarium=-164 arbitrary=-42
    arcade=-71 arch=-200 arch_=-200 arch_and=-198 arched=-94 arches=-42 archive=-71 archway=-200
    archway_=-200 archway_and=-164 archway_on=-94 archway_turn=-71 are=105 are_=200 are_a=200
    are_about=200 are_at=147 are_behind=-113 are_by=-169 are_done=11 are_facing=-200
    are_four=-94 are_given=200 are_in=-113 are_inside=-94 are_no=128 are_not=184 are_now=-200
    are_on=-164 are_out=169 are_some=-94 are_standing=-200 are_the=199 are_there=16 are_told=200
    are_two=-200 are_void=200 area=-200 area_=-164 area_and=-135 area_then=-71 area_with=-148
    aren't=-42 arguments=180 arm=-128 arm's=-71 armchair=-200 armchair_=-200 armchair_and=-94
    armchair_then=-71 armchairs=-142 armchairs_and=-113 armor=-154 armor_=-142 armour=-42
    armrest=-71 arms=-183 arms_=-164 around=-111 around_=-19 around_and=-30 around_go=-104
    around_here=109 around_it=-76 around_its=-94 around_so=-183 around_the=-200 around_then=-71
    around_to=-200 around_until=-174 arr=-42 arrival=-42 arrived=154 arrived_=200 arrow=-94
    art=-128 artwork=-71 as=143 as_a=200 as_far=-200 as_if=151 as_it=99 as_long=200 as_soon=-56
    as_the=122 as_they=109 as_this=200 as_you=-143 as_your=200 ascend=-113 ascended=-42
    ascending=-42 aside=180 ask=147 asked=200 asks=200 asks_that=200 asleep=-42 assistant=200
    assistant_=200 assumed=180 at=-119 at_a=7 at_all=99 at_any=200 at_each=200 at_every=200
    at_it=-164 at_its=-200 at_once=200 at_that=-128 at_the=-200 at_your=77 atm=-94 atrium=-71
    attempt=180 attention=38 attic=-200 attic_=-104 attic_and=-104 attic_through=-58 auntie=-42
    auntie's=-42 authorise=180 authorised=138 authority=180 automatic=-174 automatic_doors=-154
    available=-42 avoid=199 avoided=200 aw=-42 await=138 away=29 away_from=9 awful=-42
    awning=-113 axis=123 axis_=130 axis_at=119 axle=-42 aystay=180 azimuth=-42 b=-38 b_and=-94
    babe=-42 babies=-71 baby=-164 baby's=-42 baby_gate=-113 back=92 back's=-42 back_=200
    back_and=150 back_door=-200 back_from=-15 back_inside=-200 back_into=-142 back_is=109
    back_of=-191 back_on=-174 back_out=-200 back_past=-113 back_stairs=-94 back_through=109
    back_to=142 backpack=-42 backs=-71 backward=200 backward_wherever=119 backwards=169 bag=-94
    baggage=-71 balcony=-200 balcony_=-200 balcony_and=-113 bales=-71 ball=-113 balloon=-71
    ballroom=-183 ballroom_=-94 balls=-113 balls_and=-94 balusters=-42 balustrade=-71 bamboo=-71
    bananas=-128 bananas_=-94 bang=-42 banister=16 bank=-94 banquet=-71 baptismal=-71
    baptistery=-113 bar=-200 bar_=-200 bar_and=-174 bar_area=-164 bar_on=-113 bar_stool=-94
    bar_stools=-200 bar_with=-113 barbecue=-164 barbecue_=-94 barn=-174 barn_door=-113
    barometer=-71 barrel=-183 barrel_table=-113 barrels=-198 barrels_=-94 barrels_and=-154
    barrier=-113 bars=-71 barstool=-42 base=128 basement=52 basically=180 basket=-200
    basket_=-154 basket_and=-113 basketball=-71 baskets=-71 bath=-128 bathrobes=-42
    bathroom=-134 bathroom_=-123 bathroom_and=-200 bathroom_door=-113 bathroom_on=-159
    bathroom_then=-142 bathroom_with=-113 bathtub=-200 bathtub_=-200 bathtub_and=-71 battery=200
    bay=-198 bay_window=-183 be=72 be_a=-200 be_careful=-142 be_done=200 be_facing=-200
    be_in=-200 be_next=-200 be_obeyed=200 be_on=-200 be_the=-94 bead=-94 bead_curtain=-94
    beaded=-94 beaded_curtain=-94 beam=-71 bean=-71 beanbag=-154 beanbags=-71 bear=-126
    bear_=-128 bear_left=-154 bear_right=-200 bear_slightly=-94 bearing=-154 beautiful=-94
    beauty=-71 because=-200 because_the=-128 bed=-200 bed_=-200 bed_and=-200 bed_in=-94
    bed_on=-198 bed_take=-83 bed_to=-113 bed_turn=-71 bed_walk=-94 bed_with=-191 bedding=-42
    bedroom=-54 bedroom_=44 bedroom_and=-200 bedroom_at=-128 bedroom_go=109 bedroom_past=-94
    bedroom_then=-58 bedroom_with=-187 bedrooms=180 beds=-107 beds_=-198 beds_and=-142
    beds_are=109 been=200 been_cancelled=200 beers=-42 before=90 before_=199 before_it=73
    before_the=-37 before_you=142 began=200 began_=200 begin=90 begin_=199 begin_by=-7
    beginning=200 beginning_=199 begins=200 begins_=169 begun=180 behalf=180 behave=180
    behind=-200 behind_it=-191 behind_the=-200 behind_you=-200 beige=-94 being=-94 believe=-42
    bell=-164 bell_=-94 bellhop's=-71 below=200 below_is=200 belt=-94 bench=-200 bench_=-200
    bench_and=-200 bench_in=-104 bench_then=-71 benches=-142 benches_=-128 bend=-42 bends=-113
    beneath=-164 beneath_the=-113 berth=-42 beside=-117 beside_a=-94 beside_it=-142
    beside_the=-200 bestie=-42 bet=-42 better=109 between=-200 between_the=-200
    between_them=-191 between_two=-113 beyond=52 beyond_it=109 bicycle=-164 bicycle_=-113
    bicycles=-71 bidet=-94 bidet_and=-94 bifurcates=-42 big=-200 big_desk=-113 big_glass=-113
    big_window=-94 bigger=-42 biggest=-94 bike=-200 bike_=-121 bike_and=-104 bikes=-142
    bikes_and=-94 billet=-42 billiard=-113 billiard_table=-113 billiards=-71 bin=-113 bin_=-113
    bird=-42 birdbath=-142 birdbath_=-113 birdcage=-71 birds=-42 biscuit=-42 bisect=-42 bit=-54
    bit_left=-94 bit_to=-94 black=-200 black_and=-128 black_door=-113 black_railing=-83
    blackboard=-142 blackboard_=-113 blanket=-142 blanket_=-113 blankie=-42 bleachers=-71
    bless=-42 blocked=68 blocks=180 blood=-71 blue=-200 blue_carpet=-128 blue_chairs=-94
    blue_sofa=-83 blurs=180 board=31 board_=-200 board_with=-113 boardroom=-71 boat=-71 body=-42
    boiler=-191 boiler_=-154 bollard=-71 bones=-42 book=86 bookcase=-200 bookcase_=-187
    bookcase_and=-154 bookcase_then=-71 bookcases=-113 bookcases_=-113 books=-113 bookshelf=-200
    bookshelf_=-195 bookshelf_and=-83 bookshelves=-94 boom=-42 boot=-94 booth=-200 booth_=-128
    booth_and=-142 booths=-94 boots=-128 boots_and=-94 borders=180 boss=150 both=-200
    both_flights=-142 both_sides=-142 bother=180 bottles=-94 bottom=-200 bottom_=-200
    bottom_and=-94 bottom_of=-200 bottom_turn=-154 bottom_you'll=-94 bound=-94 bounds=138
    bouquet=-71 bowl=-183 bowl_=-113 bowl_of=-128 bowling=-42 box=-142 box_=-113 boxes=68
    boxes_=-94 boys=-42 branch=-71 brass=-154 bravo=-42 breach=-42 bread=-113 bread_and=-94
    break=52 break_room=-94 breakfast=-200 breakfast_nook=-200 breaking=-42 breath=-42
    breathe=-42 breather=-42 breathtaking=-42 breeze=-42 brick=-200 brick_steps=-94
    brick_wall=-183 bricked=-42 bricks=-42 bridge=-142 bridge_and=-94 bright=-113
    bright_hallway=-94 bring=-42 brings=-42 brochure=-113 broken=199 brolly=-42 bronze=-42
    broom=-71 brother=138 brother's=-42 brothers=-42 brown=-200 brown_couch=-83 brown_door=-113
    brr=-42 brrr=-42 brushes=-42 bubbles=-42 bubbling=-42 bucket=-154 bucket_=-94 buddha=-71
    buddy=-94 buffer=180 buffet=-142 buffet_=-113 build=180 building=169 building_=200 built=200
    bulb=-71 bulkhead=-42 bullet=-94 bulletin=-113 bulletin_board=-113 bum=-71 bump=-142
    bump_into=-113 bunch=-113 bunch_of=-94 bunk=-200 bunk_=-113 bunk_beds=-200 bunks=-71
    bursting=-42 bushes=-71 bust=-198 bust_=-164 bust_on=-94 but=-89 but_do=109 but_don't=-154
    but_it's=-113 but_not=-154 but_only=-94 but_turn=-113 but_you=-94 butler's=-42 butterfly=-42
    buttons=-42 by=-80 by_=68 by_a=58 by_facing=-178 by_it=-154 by_order=200 by_the=-155
    by_walking=-11 by_way=-195 bypass=-42 c=-183 cabin=-200 cabin_and=-113 cabin_door=-142
    cabinet=-200 cabinet_=-200 cabinet_and=-178 cabinet_with=-113 cabinets=-148 cabinets_=-113
    cabins=-113 cables=-94 cables_=-94 cactus=-183 cactus_=-113 caf=-142 cafe=-174 cafeteria=-42
    cage=-94 cake=-94 cake_=-94 cakes=-42 calibration=180 call=109 call_it=109 called=30
    called_a=-142 calling=180 calories=-42 came=-2 camera=128 can=-70 can't=7 can't_go=6
    can_=-142 can_and=-58 can_go=-142 can_see=-200 can_stop=-63 can_then=-128 cancel=200
    cancel_the=200 cancelled=200 cancelled_=200 cancelled_the=172 candle=-200 candle_holder=-174
    candles=-191 candles_=-113 candles_and=-113 candles_on=-94 candy=-94 cannon=-42 cannons=-42
    cannot=-42 canopy=-113 cans=-71 captain=180 captain's=-42 car=-183 car_and=-128 card=-71
    careful=-200 carefully=-42 caretaker=180 carousel=-71 carpet=-200 carpet's=-42 carpet_=-200
    carpet_and=-104 carpet_on=-71 carpet_to=-159 carpeted=-128 carpets=-42 carriage=-42
    carried=200 carry=99 carry_on=-38 carry_out=200 carrying=-71 cars=-71 cart=-142 carts=-154
    carts_=-113 case=-72 case_=-178 case_on=-113 case_walk=-58 cases=-42 cash=-200
    cash_register=-191 cask=-71 castle=-42 cat=52 cat's=-42 catalog=-42 catalogue=-42 catch=-42
    cats=180 cause=-128 cease=180 ceiling=43 ceiling_=27 cellar=-200 cellar_=-121 cellar_and=-94
    cello=-71 center=-198 center_aisle=-113 centre=-42 cereal=-113 chains=-71 chair=-82
    chair_=-182 chair_and=-183 chair_by=-154 chair_is=109 chair_on=-159 chair_walk=-83
    chair_with=-94 chairs=-110 chairs_=-200 chairs_and=-200 chairs_on=-142 chairs_turn=-58
    chalkboard=-42 chambers=-42 chance=138 chandelier=-200 chandelier's=-42 chandelier_=-200
    chandelier_and=-135 change=193 change_of=199 changed=200 changed_your=200 changes=-183
    changes_from=-174 changing=-174 changing_room=-113 changing_table=-113 chapel=-183
    chapel_=-94 chapel_and=-94 characters=-42 charge=200 charger=200 charging=16
    charging_station=-164 charlie=-71 charming=-42 chart=-142 chart_table=-113 chassis=-42
    chat=180 chatting=-42 check=-164 check_in=-113 checked=138 checkerboard=-42 checkout=-94
    checkout_counter=-94 checkpoint=-42 cheerful=-42 cheers=86 cheery=-42 chess=-113 chest=-154
    chest_=-94 chest_of=-94 chick=-42 chief=200 chief_of=200 child=180 children=-71
    children's=-42 chill=-42 chimney=-94 china=-142 china_cabinet=-142 chinese=-142 chips=-42
    chocolate=-94 chocolate_fountain=-94 choices=-42 choo=-42 choose=200 choose_the=169
    christmas=-113 christmas_tree=-113 chuck=-71 chum=-42 church=-154 church_and=-94 chute=-71
    cinderella=-42 circle=33 circle_and=200 circles=180 circular=-42 circumference=-42
    circumnavigate=-42 circumstances=200 clang=-42 clank=-42 class=-94 classroom=-174
    classroom_=-94 classroom_and=-113 claw=-42 clawed=-42 cleaner=-142 cleaner_=-94 clear=7
    clear_the=-164 clearance=138 clerestory=-42 clerk's=-71 climb=-63 climb_=199 climb_down=-94
    climb_it=52 climb_the=-200 climb_to=-94 climb_up=-113 climbed=-42 climbing=-113 climbs=180
    cloakroom=-128 clock=-200 clock_=-200 clock_and=-200 clock_go=-58 clock_on=-94 clocks=-23
    clockwise=-191 close=38 close_=-113 closed=85 closed_door=-113 closely=-42 closes=-42
    closest=-200 closest_to=-154 closet=-177 closet_=-200 closet_and=-22 closet_on=-113
    closet_then=-71 closet_with=-83 closing=-71 clothes=-200 clothing=-71 clue=-42 cmd=180
    coast=-142 coat=-200 coat_hooks=-200 coat_rack=-200 coat_room=-113 coats=-154 coats_on=-94
    coca=-142 cocoa=-42 code=109 coffee=-200 coffee_machine=-142 coffee_maker=-113
    coffee_table=-200 coffees=-42 cola=-154 cold=-42 colonnade=-71 colored=-94 colored_glass=-94
    colorful=-42 coloured=-154 column=-198 column_=-94 column_on=-71 columns=-164 comb=-42
    combined=-42 come=-19 come_back=102 come_in=-113 come_on=-94 come_out=-200 come_to=-150
    comes=100 comfy=38 coming=-42 command=200 commands=200 commands_as=200 commands_be=200
    comment=180 commode=-42 companionway=-42 compass=-42 complete=200 completely=-71
    completing=180 completion=-42 compliance=180 computer=-200 computer_=-135 computer_and=-148
    computers=-128 concern=109 concession=-42 concierge=-113 concierge's=-71 concierge_desk=-94
    concrete=-142 condition=199 conditional=-42 conference=-200 conference_room=-200
    conference_table=-113 confessional=-113 confirm=-42 confuse=180 confuses=138 confusing=-42
    consecutive=-42 consider=200 consider_the=199 consideration=-42 console=-128
    console_table=-128 constant=-42 constraint=-42 cont'd=-42 contact=-113 contact_=-94
    contains=-42 content=180 continue=-11 continue_down=-148 continue_on=-142 continue_past=68
    continue_to=-200 continue_until=6 continuous=180 contrary=200 contrary_of=184 control=108
    control_room=108 conveyor=-71 cooking=180 cooler=-200 cooler_=-195 cooler_and=-128
    coordinates=-42 copier=-200 copier_=-128 copper=-71 copy=-94 corkscrew=-42 corner=-116
    corner_=-200 corner_and=-94 corner_to=-113 correct=138 correction=200 corridor=-200
    corridor_=-191 corridor_and=-121 corridor_past=-142 corridor_to=-94 costumes=-113 cot=-71
    cots=-94 couch=20 couch_=20 couch_and=-51 couch_on=-94 couch_turn=-104 couches=-200
    couches_and=-94 could=-18 could_you=6 couldn't=-42 council=180 count=87 count_the=-113
    counted=-42 counter=-200 counter_=-200 counter_and=-200 counter_clockwise=-94
    counter_turn=-71 counting=-42 country=-42 counts=200 couple=-198 couple_of=-198 course=-94
    courtyard=-174 courtyard_and=-94 cousin's=-71 cover=-94 covered=-42 cowboy=-71 cozy=-94
    cr=-142 crate=-71 crayons=-42 cream=-94 creep=180 crest=-42 crib=-200 crib_=-183
    crib_and=-113 crib_go=-94 cribs=-42 cried=-42 cross=-154 cross_on=-142 cross_over=-191
    cross_the=-200 cross_to=-94 crossed=-42 crosses=-42 crossing=109 crying=-42 crypt=-42
    crystal=-94 crystals=-42 cubbies=-71 cubicle=-128 cubicles=-113 cue=-42 cues=-42 cup=-42
    cupboard=-200 cupboard_=-113 cupboards=-42 cuppa=-42 cups=-42 curl=-42 curlers=-42
    currency=-71 current=200 currently=-42 curtain=-200 curtain_=-200 curtain_and=-200
    curtained=-71 curtains=-128 curtsy=-42 curved=-174 curved_stairs=-154 curves=-94 curving=-42
    curvy=-42 cushion=-198 cushion_=-183 cushions=-71 cut=169 cute=-94 cutest=-42 cutter=-71
    cylinder=-42 cylinders=-71 d=52 da=-71 dad=138 daddy's=-42 daft=-42 damage=180 dance=-142
    dance_floor=-128 dancer=180 dancing=-42 danger=-142 dark=-174 darkroom=-42 darling=-42
    dartboard=-164 dartboard_=-154 date=200 davenport=-71 dawdle=-94 day=200 day_=184
    daylight=-42 dead=-113 dead_ahead=-94 dear=-71 decided=180 decimetre=-42 decision=180
    deck=-98 deck_=-38 deck_with=-94 decking=-42 declare=180 decode=180 deep=-113 deer=-113
    deer_head=-113 defined=-42 definition=-42 degree=-94 degrees=-200 degrees_=-183
    degrees_and=-128 degrees_left=-113 degrees_right=-154 degrees_so=-94 degrees_to=-191
    delete=200 delivers=-42 delta=-71 demo=-142 den=-183 den_=-121 den_and=-71 denied=180
    dentist's=-42 depart=-42 department=-71 descend=-38 descend_the=-198 descending=-71
    descends=-42 describe=180 described=200 described_=200 description=200 design=-42 desk=-200
    desk_=-200 desk_and=-200 desk_on=-142 desk_the=-174 desk_to=-104 desk_turn=-94
    desk_walk=-104 desk_with=-200 desks=-200 desks_=-94 desks_and=-128 destination=137
    detailed=-42 detect=-42 detective=-42 determine=-42 developer=200 developer's=-142
    deviate=-42 deviation=-42 dexter=-42 di=-42 diagonally=-154 diagonally_to=-94
    diametrically=-42 dictionary=-71 did=200 did_last=200 different=138 ding=-71 dingy=-42
    dining=-200 dining_room=-200 dining_table=-200 dinosaur=-154 dinosaur_skeleton=-94
    direction=77 direction_of=6 direction_you=200 directional=180 directions=200 directions_=200
    directions_are=200 directions_that=172 directly=-154 directly_beneath=-94 director=180
    dirty=-42 disabled=180 disco=-71 dishwasher=-200 dishwasher_=-142 dishwasher_and=-104
    displacement=-42 display=-200 display_case=-174 disregard=200 disregard_all=157
    disregard_the=164 distance=67 distance_to=-164 distances=180 diving=-71 dizzy=-42 dj=-71
    do=170 do_=200 do_any=200 do_is=-18 do_it=200 do_me=-94 do_not=171 do_nothing=137
    do_only=200 do_that=-94 do_the=200 do_what=200 do_you=-128 dock=200 doctor=180 doctor's=16
    document=200 does=161 does_not=200 doesn't=-71 dog=-200 dog's=-42 dog_bed=-94 dogleg=-42
    doing=200 dokey=-42 doll=-42 dolls=-94 don't=-21 don't_climb=-113 don't_enter=-142
    don't_go=-49 don't_have=-94 don't_need=-94 don't_stop=6 don't_take=-2 don't_turn=-164
    done=136 done_=199 done_once=-83 done_when=-198 dong=-42 donotfollowtheroute=180 dont=180
    dooor=180 door=-123 door's=-42 door_=-150 door_a=-94 door_and=-159 door_at=-154 door_b=-94
    door_behind=-174 door_by=-94 door_go=32 door_in=-200 door_into=-142 door_is=67 door_left=-94
    door_near=-113 door_next=-164 door_not=-154 door_of=-164 door_on=-200 door_opposite=-164
    door_says=99 door_stop=-113 door_that=50 door_that's=-183 door_the=-200 door_then=-200
    door_there=-164 door_to=-200 door_turn=45 door_with=-200 door_without=-94 door_you=29
    doormat=-174 doormat_=-164 doors=-185 doors_=-182 doors_and=-200 doors_are=-94 doors_at=-94
    doors_go=-148 doors_on=-200 doors_one=-94 doors_that=109 doors_then=-178 doors_with=-94
    doorway=-148 doorway_=-42 doorway_and=-178 doorway_of=-200 doorway_on=-169 doorway_then=-58
    doorway_to=-154 doorway_walk=-15 doorway_with=-128 doorways=-42 double=-27 double_doors=-200
    doubling=-42 doubt=180 down=-96 down_=31 down_a=-128 down_and=200 down_five=-154
    down_it=-183 down_on=109 down_one=-200 down_the=-200 down_them=-183 down_three=-174
    down_to=-68 down_two=-164 down_until=-94 downstairs=-113 downwards=-42 dr=38 drafting=-94
    drafting_table=-94 drain=-71 drawbridge=-71 drawers=-154 drawers_=-113 drawing=-71 drawn=-42
    dreadful=-42 dreamy=-42 drenched=-42 dresser=-200 dresser_=-191 dresser_and=-83
    dresser_on=-58 dresser_then=-169 dresses=-71 dressing=-198 dressing_room=-191 dried=-71
    drifting=-42 drill=109 drink=-42 drinking=-142 drinking_fountain=-142 drinks=-71 drip=-42
    drive=169 drives=-42 drop=200 drop_this=140 drown=-42 drum=-191 drum_kit=-164 drums=-142
    drums_=-94 dryer=-200 dryer_=-183 dryers=-71 duck=-71 ducts=-42 ductwork=-42 dumbbells=-71
    dumpling=-42 dumpster=-71 dumpsters=-71 dungeon=-42 during=180 duties=180 duty=-42 e=-191
    each=200 each_direction=200 each_doorway=184 each_minute=184 each_other=-142 each_step=183
    each_time=200 each_turn=200 earlier=200 ears=-71 easel=-164 easel_=-94 easel_and=-128
    easiest=-42 easy=-128 eat=-71 eating=-42 ebg=180 edge=-200 edge_=-113 edge_of=-200 edges=-71
    effect=199 eggs=-71 egress=-42 egyptian=-42 eight=86 eighth=-71 either=-154 element=-42
    elephant=-71 elevation=-42 elevator=-200 elevator_=-174 elevator_and=-191
    elevator_doors=-113 elevator_lobby=-113 elevators=-191 elevators_=-154 eleven=-71 else=185
    emergency=68 emit=200 empty=-42 end=-29 end_=-172 end_and=-31 end_at=-164 end_go=-113
    end_of=-101 end_so=109 end_the=200 end_this=200 end_turn=-142 end_up=38 end_you'll=-94
    endlessly=180 ends=-46 ends_=-174 ends_at=-174 energy=180 engine=-113 engine_room=-113
    engineer=180 engineers=180 engines=180 enjoy=-42 enjoying=-42 enough=169 enter=-40
    enter_=-183 enter_a=199 enter_and=52 enter_the=-125 enter_through=-183 entering=-164
    entering_any=-94 entertainment=-71 entrance=-200 entrance_and=-94 entrance_to=-113
    entry=-142 entryway=-195 entryway_=-113 entryway_and=-71 environment=-42 episode=200
    episodes=180 equipment=-71 erase=180 erehay=180 errand=180 error=199 escalator=-200
    escalator_=-183 escalator_up=-94 escalators=-42 espresso=-71 essential=200
    essential_that=200 ethay=180 ethics=180 evacuation=-142 even=86 event=-71 ever=200 every=200
    every_door=87 every_few=157 every_instruction=200 every_landmark=200 every_order=184
    every_time=120 every_turn=200 everybody=109 everyone=150 everything=160 everywhere=109
    eway=180 ex=-42 exactly=199 exam=-94 exceed=180 except=169 exception=180 exchange=109
    exchanged=200 exclude=-42 excluded=-42 execute=86 executed=180 executing=200 execution=-42
    exercise=-191 exercise_bike=-154 exit=-200 exit's=-42 exit_=-191 exit_and=38 exit_sign=-200
    exit_the=-200 exit_through=-164 exits=-42 expanded=-42 exploring=180 exposed=-42
    extinguisher=-200 extinguisher_and=-164 extract=-42 ey=-42 eye=-113 eyepiece=-42 eyes=-94
    f=-42 face=-45 face_=-94 face_away=-113 face_the=-52 facing=-200 facing_a=-200 facing_it=-94
    facing_the=-200 failure=180 fake=-42 fall=-164 falling=-42 family=-159 family_room=-148
    fan=-113 fancy=-42 far=-200 far_as=-200 far_corner=-164 far_door=-128 far_end=-200
    far_left=-142 far_side=-154 far_wall=-198 farther=-94 farthest=-94 faster=-42 fault=180
    favor=-42 favour=-42 feel=68 feet=-66 feet_=-94 feet_from=-164 feet_to=-135 fella's=-42
    fellow=-42 fence=-128 fence_=-128 fern=-174 fern_=-164 fetched=-42 fetches=180 few=50
    few_feet=-135 few_steps=44 fgbc=180 ficus=-71 fiddling=-42 field=-42 fifteen=-42 fifth=-128
    fig=-71 file=-71 filing=-154 filing_cabinet=-128 fill=-42 filled=-42 fills=-42 film=-71
    final=-94 finally=-42 find=-200 find_a=-200 find_it=-183 find_me=-113 find_the=-200
    find_yourself=-94 fine=68 finish=153 finished=166 finished_=169 fire=-27
    fire_extinguisher=-200 fire_hose=-113 fireplace=-200 fireplace_=-200 fireplace_and=-200
    fireplace_then=-83 fireplace_to=-83 fires=-42 firewood=-71 first=-16 first_=166
    first_and=-154 first_bar=-94 first_door=-122 first_is=-94 first_landing=-200 first_left=-113
    first_of=15 first_opening=-142 first_right=-154 first_room=62 first_row=-94 first_seat=-113
    first_step=67 first_table=-113 first_two=-191 first_window=-113 first_you=-113 firstly=-42
    fish=-200 fish_tank=-200 fitting=-113 fitting_room=-94 five=-66 five_steps=-178 fixed=180
    fixtures=-42 flag=-94 flags=-142 flank=-42 flap=-94 flat=-94 flight=-200 flight_=-94
    flight_of=-200 flights=-200 flights_of=-191 flip=200 flipped=180 float=-71 floor=-47
    floor_=-104 floor_and=16 floor_changes=-164 floor_go=-94 floor_in=109 floor_is=199
    floor_lamp=-142 floorboard=-71 floors=-154 floors_=-94 flop=-71 flower=-174 flower_shop=-94
    flower_stand=-113 flowers=-183 flowers_=-113 flowers_on=-94 fluffy=-94 fold=-71 folding=-94
    follow=-42 follow_=119 follow_it=-200 follow_so=119 follow_the=-109 followed=138
    following=172 following_steps=200 following_the=52 follows=200 follows_=199 font=-174
    font_=-113 font_and=-94 food=-71 foosball=-142 foosball_table=-142 foot=-200 foot_of=-200
    footstool=-42 for=119 for_a=-39 for_all=200 for_it=86 for_me=-11 for_right=200 for_the=76
    for_this=125 for_today=200 for_you=137 for_your=147 forbid=180 forbidden=180 forbids=200
    forbids_you=200 forget=200 forget_the=58 forgetting=-42 forgot=-113 forgotten=180 fork=-174
    forks=-42 form=-71 forth=-42 forward=-113 forward_=-119 forward_and=-142
    forward_between=-113 forward_down=-94 forward_past=-183 forward_to=-142 forward_two=-94
    forwards=-42 found=200 found_it=200 fountain=-200 fountain_=-200 fountain_and=-94 four=-149
    four_step=-58 four_steps=-164 four_windows=-113 fourteen=-71 fourth=-31 fourth_door=16
    foyer=-111 foyer_=-61 foyer_and=-94 foyer_with=-83 frame=-113 framed=-113 free=-94
    freedom=-42 freely=180 freeze=138 freezer=-191 freezer_=-174 french=-200 french_doors=-200
    freshen=-42 fresher=-42 fridge=-200 fridge_=-200 fridge_and=-195 fridge_then=-104 friend=-2
    friend_=-94 friend_and=-94 friendly=-94 from=57 from_here=27 from_it=114 from_now=200
    from_the=-17 from_there=-198 from_where=109 from_your=199 front=-147 front_=68
    front_desk=-174 front_door=-86 front_of=-180 front_pew=-94 frosted=-71 frozen=138 fruit=-94
    ft=-142 full=9 full_access=184 full_of=-164 fully=-42 fun=68 function=-42 functional=-42
    funnily=-42 furnace=-71 furniture=199 further=200 further_=113 fuse=-71 fuss=-42 future=180
    gallery=-174 gallery_=-94 gallery_and=-113 galley=-94 game=-174 game_room=-164 gangway=-71
    gap=-200 gap_between=-94 garage=-86 garage_=-22 garage_by=-71 garage_go=-83 garden=-31
    garden_=38 gardening=-42 gas=-113 gate=-200 gate_=-200 gate_and=-94 gate_in=-113 gave=200
    gawp=-42 gazebo=-71 gears=180 geese=-42 general=200 generator=-113 generator_=-113
    generous=180 gentle=-71 gently=-71 get=-195 get_in=-113 get_off=-94 get_out=-200 get_there=6
    get_to=-200 get_you=-113 gets=-42 getting=-42 giant=-142 gift=-183 gift_shop=-183 give=6
    give_it=-94 given=200 given_=200 gives=200 giving=-42 glamorous=-42 glass=-164 glass_=38
    glass_and=-94 glass_case=-94 glass_door=-200 glass_doors=-200 glass_table=-200
    glass_walls=-113 glass_window=-113 glasses=-128 glasses_=-94 glazed=-71 glazing=-42
    globe=-200 globe_=-183 globe_and=-128 globes=-42 glowing=-71 glug=-42 go=-101 go_=87
    go_across=-94 go_ahead=-142 go_all=-200 go_along=-200 go_and=-164 go_any=52 go_anywhere=200
    go_around=-200 go_back=187 go_backward=200 go_behind=-113 go_between=-200 go_by=-200
    go_down=-200 go_forward=-36 go_from=-174 go_halfway=-94 go_home=200 go_in=-89 go_inside=-113
    go_into=-107 go_left=-79 go_on=28 go_out=-200 go_outside=-200 go_over=-94 go_past=-200
    go_right=-65 go_round=-54 go_slightly=-128 go_straight=-200 go_the=169 go_there=52
    go_through=-183 go_to=-107 go_toward=-200 go_towards=-191 go_under=-191 go_up=-176 goal=200
    goal_=200 goal_is=113 goals=180 goes=62 goes_to=-113 going=-99 going_down=-154 going_in=-142
    going_left=-94 going_past=-128 going_straight=-178 going_through=-128 going_to=-3
    going_until=-200 going_up=-164 gold=-200 golden=-94 gone=-31 gone_past=-94 good=163
    good_=199 goodbye=180 goodies=-42 gorgeous=-113 got=-200 got_a=-198 got_to=-94 gowns=-42
    grab=-42 gradient=-42 gramophone=-71 gramophone's=-42 gran's=-42 grand=-42 grandad's=-42
    grandfather=-200 grandfather_clock=-200 grass=-142 grate=-42 grating=-42 graveyard=-71
    gray=-200 great=86 green=-200 green_=-142 green_chair=-113 green_chairs=-113 green_door=-128
    greenhouse=-42 greeted=-71 grey=-200 grey_couch=-83 grill=-200 grill_=-200 ground=-94
    ground_floor=-94 grown=-113 guard=200 guard's=-164 guard's_chair=-164 guardrail=-42
    guess=-94 guest=29 guest_room=-198 guests=180 guidance=180 guitar=-113 gumball=-113
    gumball_machine=-113 gun=-142 gym=-200 gym_and=-121 gym_with=-94 gymnasium=-94 ha=-71 had=38
    haha=-42 hair=-128 half=39 half_landing=-94 half_of=200 half_right=-94 halfway=-200
    hall=-200 hall's=-42 hall_=-200 hall_and=-114 hall_by=-128 hall_into=-142 hall_of=-113
    hall_then=-159 hall_through=-94 hall_turn=-83 hall_with=-164 hallway=-175 hallway_=-165
    hallway_and=-200 hallway_as=-94 hallway_in=-94 hallway_on=-191 hallway_past=-200
    hallway_splits=-174 hallway_then=-128 hallway_to=-174 hallway_turn=-121 hallway_with=-200
    hallways=-94 hallyway=-142 halt=53 halt_=77 halt_at=-7 halt_by=-94 hammock=-128 hamper=-142
    hamper_and=-94 hamster=-71 hand=51 hand's=180 hand_=86 hand_door=-142 hand_for=200
    hand_side=-198 handedness=180 handles=-71 handrail=-142 hands=138 hang=-200 hang_a=-200
    hanging=-200 hanging_on=-142 hangs=-174 hansen=180 happens=180 happy=-142 hard=-200
    hard_left=-164 hard_right=-94 hard_to=-113 hardwood=-71 harp=-198 harp_=-94 harp_and=-128
    harpsichord=-113 harpsichord_=-113 has=191 has_a=-200 has_been=200 has_cancelled=172
    has_changed=200 has_closed=200 has_no=109 has_to=200 has_withdrawn=140 hat=-191 hat_=-94
    hat_stand=-113 hatch=-198 hatch_=-174 hats=-42 have=150 have_a=27 have_arrived=123
    have_been=200 have_found=199 have_gone=27 have_reached=113 have_to=67 having=-94 hay=-142
    he=96 he's=-42 head=-11 head_down=-128 head_for=-154 head_of=199 head_office=200 head_on=-94
    head_out=-154 head_straight=-94 head_through=-94 head_to=-200 head_towards=-187 heading=-200
    heading_you=-94 headquarters=180 headroom=-42 heads=-42 health=180 hear=169 heard=200
    heart=-42 hearth=-71 heated=-42 heater=-128 heater_=-94 heave=-42 heavy=-164 hedge=-113
    heed=180 height=-71 helical=-42 hello=86 help=-71 helps=-71 hence=-71 her=-113 here=146
    here's=-94 here_=127 here_and=200 hereby=200 herein=180 hex=180 hey=128 hi=68 hidden=-71
    hiding=-42 high=-200 high_chair=-142 high_chairs=-94 higher=52 highest=-71 hill=-42 him=-200
    him_=-191 hint=-42 his=-128 hit=68 hit_the=-113 hm=-42 hold=7 hold_=68 hold_at=-198
    hold_by=-113 hold_on=-200 hold_position=86 holder=-174 holder_=-83 holder_and=-104
    holding=-42 holds=-42 hole=-71 home=200 home_=200 hon=-42 hook=-128 hooks=-200 hooks_=-200
    hooks_and=-113 hoop=-71 hooray=-42 hoover=-94 hop=86 horizontal=109 horse=-200 horse's=-42
    horse_=-183 horses=-42 hose=-142 hose_=-128 hospital=-11 hospital_bed=-183 hot=-200
    hot_tub=-200 hotel=-183 hour=180 hours=180 house=84 house_=116 houses=-42 hover=-42 how=-128
    how_to=-94 huge=-128 human=180 hun=-42 hung=-42 hungry=-42 hunt=-42 hurry=-191 husband=-42
    hut=-71 i=115 i'd=169 i'll=16 i'm=-174 i've=-128 i've_got=-113 i_am=200 i_can't=109 i_e=-183
    i_have=200 i_know=-128 i_left=-142 i_mean=-191 i_need=38 i_say=77 i_want=-200 ice=-200
    ice_cream=-94 ice_machine=-200 idea=-42 identical=-42 idle=-42 if=83 if_it=52 if_they=200
    if_you=39 if_you're=-94 ignore=136 ignore_the=98 ignored=-42 ignorethenextstep=180
    ignoring=138 ii=-71 iii=-71 ikea=-142 image=180 imagine=109 immaterial=-42 immediate=199
    immediately=23 immediately_=109 immediately_and=109 important=180 in=-26 in_=-87 in_a=-52
    in_all=200 in_an=-142 in_and=-200 in_at=-164 in_between=-200 in_by=-94 in_charge=200
    in_closet=-154 in_front=-177 in_go=169 in_it=-25 in_place=200 in_reverse=200 in_that=-128
    in_the=-109 in_there=-123 in_this=200 in_through=-191 in_turn=16 in_you=109 in_your=200
    inch=180 inclination=-42 increased=180 indefinitely=180 indications=180 indoor=-71
    indoors=-42 infiltrate=-42 information=-113 ingress=-42 initial=109 injured=180 inner=-94
    innocent=-42 inside=-200 inside_=-200 inside_and=-178 inside_it=-94 inside_the=-200
    inside_then=-71 inside_through=-159 insists=-42 inspector=180 inspectors=180 instance=-42
    instead=131 instead_=200 instead_of=67 instruction=200 instruction_=200 instructions=166
    instrument=-42 interchanged=180 intermediate=-42 internal=-42 interpret=200 intersection=-71
    intersects=-42 intervening=-42 into=-159 into_a=-63 into_it=-94 into_the=-200 invert=180
    inverted=200 inviting=-42 iron=-198 iron_door=-142 iron_gate=-94 ironing=-174
    ironing_board=-174 is=104 is_=43 is_a=15 is_an=52 is_and=-94 is_at=6 is_behind=-174
    is_called=68 is_cancelled=99 is_closed=114 is_essential=200 is_in=16 is_just=-94 is_left=-94
    is_named=200 is_next=-174 is_no=200 is_not=200 is_nothing=77 is_off=199 is_on=-55 is_only=99
    is_open=38 is_out=199 is_right=169 is_the=-33 is_to=189 is_void=200 is_where=-200
    is_written=200 is_wrong=200 is_your=27 is_yours=-94 island=-200 island_=-135 island_and=-135
    island_on=-121 isn't=86 issue=200 issued=200 it=32 it'll=68 it's=-72 it's_a=-31
    it's_got=-128 it's_just=-94 it's_left=-94 it's_like=-113 it's_not=-94 it's_the=-200 it_=8
    it_a=-113 it_and=-133 it_by=-94 it_curves=-94 it_down=-94 it_ends=38 it_go=-113 it_goes=-94
    it_has=58 it_in=109 it_into=-94 it_is=86 it_looks=-164 it_on=-200 it_right=86 it_says=200
    it_stop=-94 it_tells=119 it_the=169 it_then=-94 it_there's=-113 it_through=-142 it_to=-84
    it_turn=-128 it_until=-113 it_was=200 it_with=68 it_you=-94 item=-42 itinerary=180 its=-52
    its_end=-200 its_far=-164 its_left=-183 its_near=-94 its_right=-200 its_tail=-94 itself=-94
    iv=-128 jackets=-142 jackets_=-113 jacuzzi=-159 jacuzzi_and=-94 jacuzzis=-23 jigsaws=-42
    job=114 job_is=86 jog=-42 joke=180 journey=109 journey_ends=109 judge's=-42 jug=-71
    juice=-94 jukebox=-154 jukebox_=-113 junction=86 just=-42 just_a=-174 just_after=-94
    just_before=-200 just_go=-59 just_inside=-200 just_outside=-178 just_past=-94 just_stop=-128
    just_to=-94 just_turn=-94 just_walk=-113 k=-71 keep=-22 keep_going=-129 keep_on=-191
    keep_out=109 keep_right=-94 keep_the=-200 keep_to=-200 keep_turning=200 keep_walking=-38
    keeping=-200 keeping_it=-183 keeping_the=-142 keeping_them=-94 keeping_to=-128 keeps=-71
    kept=-71 kettle=-42 kevin=-42 key=-42 keyboard=-113 keypad=-71 keys=-154 kick=-42
    kiddies=-42 kidding=138 kids=-42 kill=-142 killing=-71 kiln=-42 kind=52 kind_of=-94
    kindly=200 kindness=-42 king=-71 king's=-42 kiosk=-71 kit=-200 kit_=-174 kitchen=-83
    kitchen_=-127 kitchen_and=-3 kitchen_door=86 kitchen_doorway=-94 kitchen_island=-200
    kitchen_now=-142 kitchen_past=-94 kitchen_sink=-113 kitchen_through=-135 kitchen_with=-94
    kitchen_you=-191 kitchenette=-113 knee=-42 knees=-42 knife=-71 knight=-42 knob=-71 knock=-71
    knocker=-71 know=-2 knows=180 l=-200 l_=-164 la=-42 lab=-71 label=200 labelled=-142 lad=-42
    ladder=-200 ladder_=-191 ladder_and=-200 ladder_on=-113 ladder_to=-94 ladies=-42 lady=-94
    lady's=-42 lamp=-200 lamp_=-200 lamp_and=-200 lamp_on=-164 lamps=-198 landing=-200
    landing_=-200 landing_and=-183 landing_turn=-154 landings=-42 landlord=180 landmark=200
    landmark_is=199 landmarks=-42 landscape=-71 lane=-42 lantern=-71 lap=-113 large=-200
    largest=-42 last=63 last_=200 last_door=-104 last_every=119 last_one=-38 last_step=113
    last_stool=-113 last_thing=-191 lasts=200 lasts_=172 later=180 lateral=138 lathe=-71
    latin=-42 laugh=180 laundry=-200 laundry_basket=-174 laundry_room=-200 lava=-71 law=180
    lawful=180 lawn=-71 lawyers=180 layman=-42 lead=58 leading=-113 leads=-128 leaf=-42
    leaning=-71 learn=-42 least=180 leather=-200 leather_chair=-83 leather_couch=-94 leave=8
    leave_=113 leave_by=-198 leave_it=109 leave_the=-59 leave_this=125 leave_through=-183
    leaves=-71 leaving=-200 leaving_the=-200 left=-147 left_=-151 left_90=-142 left_across=-94
    left_after=-200 left_again=-200 left_along=-113 left_and=-162 left_around=-198 left_as=-49
    left_at=-200 left_before=-128 left_by=-142 left_corner=-142 left_down=-142 left_enter=-135
    left_for=84 left_go=-200 left_halfway=-94 left_hall=-94 left_hand=-11 left_in=-198
    left_into=-114 left_is=137 left_just=-94 left_my=-154 left_not=-113 left_of=-200
    left_one=-183 left_out=52 left_pass=-94 left_past=-195 left_side=-200 left_so=-142
    left_staircase=-94 left_the=-154 left_then=-200 left_there=-200 left_through=-198
    left_to=-63 left_towards=-113 left_turn=82 left_until=-154 left_up=-94 left_walk=-113
    left_wall=-128 left_when=86 left_where=-128 left_with=52 leftmost=-113 lefts=-42
    leftward=-42 leg=-198 legend=-42 lego=-142 legs=-42 leisurely=-42 lemon=-71 length=-183
    length_of=-113 lent=-42 less=-42 let=86 let's=-80 let's_get=-128 let's_start=-94 letter=147
    letters=-142 level=-128 librarian=-42 library=-200 library_=-113 library_and=-113 lie=-71
    lied=180 lies=180 lieu=-42 life=77 life_jackets=-142 lifeboat=-113 lifeboat_=-94
    lifeboats=-113 lifebuoy=-113 lifebuoy_=-113 lifeguard=-94 lifeguard's=-42 lift=-7 lift_=-18
    lifts=-42 light=-183 lighted=-42 lighthouse=-71 lights=-94 like=-5 like_a=44 like_the=-154
    like_you're=-174 limb=-42 limit=-42 limits=138 line=-104 line_on=-154 lined=-42 linen=-200
    linen_closet=-191 linen_cupboard=-94 lines=-154 lintel=-42 lion=-142 lions=-71 list=200
    listen=-42 lit=-94 literally=-71 little=-200 little_=-164 little_and=-142 little_bit=-94
    little_hallway=-94 little_table=-94 living=-93 living_room=-93 load=-42 loading=-71
    lobby=-200 lobby's=-42 lobby_=-200 lobby_and=-200 lobby_to=-94 lobby_with=-94 locate=-198
    locate_a=-142 locate_the=-94 location=138 locked=128 locker=-94 locker_room=-94 lockers=-200
    lockers_=-191 lockers_and=-154 locomotion=180 loft=-191 loft_=-154 login=-142 lol=180
    long=-57 long_as=200 long_hallway=-113 long_part=-94 long_table=-83 long_wooden=-94
    longer=200 loo=-71 loo's=-42 look=-88 look_at=16 look_down=-94 look_for=-137 look_to=-94
    looking=72 looking_at=-191 looking_for=169 looks=-7 looks_like=43 loom=-71 loop=180
    loose=-42 lose=-42 lost=-128 lot=-164 lot_of=-128 lots=-154 lots_of=-154 loud=-42
    loudspeakers=-42 lounge=-200 lounge_=-128 lounge_and=-128 lounge_chairs=-128 lounge_go=-58
    lounger=-71 loungers=-128 loungers_=-94 love=-94 lovely=-174 low=152 lower=-113 lowest=-42
    luck=-42 lucky=-42 luggage=-113 lunch=-113 lying=180 m=-200 m_=-164 m_and=-94 machine=-200
    machine's=-42 machine_=-200 machine_and=-200 machine_on=-142 machine_then=-104
    machine_with=-94 machines=-195 machines_=-128 made=43 made_of=-154 made_out=-94 magazine=-71
    magazines=-113 magazines_=-94 magnificent=-42 magnitude=-42 mailbox=-154 mailbox_=-113
    mailboxes=-183 main=-142 maintain=-42 majesty=-42 make=-168 make_a=-200 make_for=-164
    make_your=-200 maker=68 makers=180 makes=-142 makeup=-94 making=-94 man=87 management=200
    manager=200 manager's=-113 mannequin=-142 mannequin_=-94 mannequins=-71 manoeuvre=180
    mantelpiece=-42 manufacturer=200 many=-94 map=146 map's=-42 map_=-154 marble=-200
    marble_bust=-113 marble_stairs=-113 marble_statue=-113 march=-71 margin=180 mark=-94
    marked=-164 market=-42 married=-42 marshal=200 marta=180 masks=-71 massage=-200
    massage_room=-113 massage_table=-154 massages=-42 massive=-42 master=-154
    master_bedroom=-154 mat=-200 mat_=-200 mate=-71 mats=-71 matter=200 may=200 maybe=-42 me=62
    me_=67 me_a=-154 me_to=200 mean=-11 mean_the=-94 meaning=-71 means=150 meant=96 measure=180
    measuring=-42 meet=138 meeting=-164 meetings=-42 memory=200 mention=180 mentioned=200
    mentioned_=200 mere=-42 mess=-128 message=200 message_from=200 metal=-200 metal_stairs=-164
    meteor=-42 meteorite=-71 meter=-113 meters=-200 meters_=-94 meters_and=-142 metre=-42
    metres=184 mezzanine=-71 microfilm=-71 microwave=-200 microwave_=-187 microwave_and=-83
    microwaves=-23 middle=-134 middle_=-113 middle_aisle=-113 middle_and=-94 middle_between=-113
    middle_of=-46 middle_one=-113 midpoint=-42 might=-142 milk=-94 miller's=-142 million=-42
    mind=115 mind_=109 mind_the=27 mine=-71 mine's=-42 minerals=-71 mini=-71 minimise=-42
    minimum=-42 ministry=180 mint=-42 minus=-71 minute=200 minute_=200 minutes=180 mirror=-102
    mirror_=-200 mirror_and=-187 mirror_on=-113 mirror_then=-94 mirror_with=-94 mirrored=165
    mirrored_=200 mirrored_wall=-113 mirrors=-200 mirrors_=-94 mirrors_on=-164 misc=-142
    misreading=-42 miss=138 misses=-42 missing=-42 mission=67 mistake=199 mister=-42
    mistletoe=-71 mix=200 mode=200 moment=199 money=-71 monitors=-71 mood=-42 mop=-154 more=75
    more_=200 more_step=-113 more_steps=-142 more_than=199 mosey=-113 most=-42 mother=52
    mother's=-42 motion=200 motionless=180 motors=180 mount=-42 mountains=-71 mounted=-71
    move=108 move_=200 move_away=-195 move_forward=-164 move_toward=-178 movement=200 moves=138
    movie=-42 moving=153 moving_=157 moving_walkway=-154 much=180 mud=-178 mud_room=-178
    mudroom=-71 mum=138 mum's=-42 mummies=-71 mummy=-142 mummy's=-42 mummy_and=-113 museum=-128
    museum_in=-94 music=-142 music_room=-142 must=200 must_go=200 must_not=200 my=63
    my_friend=68 my_mother=52 n=180 nag=-42 nah=180 nail=-71 name=109 named=200 named_=200
    narrator=180 narrow=-200 narrow_hallway=-113 narrow_passage=-94 naturally=-42 nave=-94
    navigation=200 nd=147 near=-54 near_it=-113 near_the=-122 nearer=-42 nearest=-70
    nearest_mirror=-94 nearest_the=-164 nearest_toilet=-183 nearly=-71 necessary=180 need=93
    need_a=38 need_is=-11 need_not=200 need_to=26 needed=-42 needn't=-42 negate=180 negative=109
    neighbor=-42 neighborhood=-42 neighbour=180 neither=-42 nemo=-42 neon=-94 nephew=-42
    never=200 never_mind=99 new=200 newel=-71 news=180 newspaper=-71 newspapers=-113
    newspapers_=-94 newsstand=-71 next=-68 next_=190 next_door=-200 next_left=-83 next_one=67
    next_room=-164 next_to=-200 nice=-191 nicer=180 niche=-71 night=-42 nightstand=-191
    nightstand_=-113 nine=-113 ninety=-183 ninety_degrees=-113 nip=-71 no=131 no_=199
    no_further=-154 no_longer=200 no_more=-142 no_need=200 nobody=191 nominal=-42 none=200
    none_of=200 nonsense=180 nook=-200 nook_=-159 nook_and=-113 nook_with=-83 normal=-113
    north=-113 northbound=-42 nose=-94 not=141 not_a=86 not_allow=200 not_do=200 not_enter=200
    not_go=73 not_move=200 not_pass=52 not_right=-94 not_stop=43 not_take=132 not_that=38
    not_the=-146 not_to=77 not_turn=113 not_up=-94 not_use=150 not_walk=200 note=200 nothing=134
    nothing_=200 nothing_in=52 notice=198 notice_a=50 notice_board=-94 notice_the=200
    notice_your=157 noticeboard=-42 noting=-42 november=-42 now=42 now_=200 now_and=169
    now_go=-142 now_in=-200 now_on=200 now_so=-142 now_there=109 now_turn=-164 now_walk=-142
    now_you=-200 now_you're=-174 nowhere=-42 nulling=-42 number=50 number_three=-113 numbers=-42
    nurse=199 nurse's=-174 nursery=-200 nursery_=-159 nursery_and=-178 nursery_then=-71
    nurses=-128 nurses_station=-94 o=-142 o'clock=-198 o'clock_and=-94 obey=200 obeyed=200
    obeyed_=200 object=200 objective=-94 oblique=-71 observation=-42 obstacle=-71 obstacles=-42
    obvious=-42 obviously=-71 occupies=-42 occurs=-42 ocean=-42 octagonal=-71 of=-23 of_3=-94
    of_90=-94 of_a=-125 of_all=128 of_an=-94 of_apples=-94 of_armor=-154 of_black=-94
    of_chairs=-159 of_doors=-2 of_drawers=-94 of_each=200 of_every=200 of_feet=-164
    of_flags=-113 of_green=-113 of_it=-81 of_management=172 of_one=-94 of_seats=-142
    of_stairs=-200 of_steps=-154 of_tables=-94 of_that=67 of_the=-70 of_them=-80 of_these=200
    of_this=200 of_those=-113 of_three=-94 of_what=200 of_which=-94 of_white=-113
    of_windows=-113 of_you=-74 of_your=193 off=93 off_=200 off_from=-94 off_the=-2 off_to=-113
    offer=-42 office=-45 office_=-118 office_and=-200 office_does=119 office_has=200
    office_with=-121 officer=200 official=200 offline=180 offset=-42 ok=200 ok_=200 okay=-95
    okay_=109 okay_so=-128 okey=-42 old=43 old_man=-94 older=-42 ollie=-42 on=-106 on_=-31
    on_a=-98 on_and=-18 on_both=-128 on_by=-94 on_down=-94 on_going=-128 on_it=-96 on_its=-200
    on_left=-142 on_out=-94 on_past=-174 on_right=-164 on_straight=-94 on_the=-136 on_this=38
    on_through=-113 on_to=-200 on_top=-94 on_treat=200 on_until=68 on_up=-94 on_wheels=-113
    on_your=-189 once=65 once_=200 once_and=52 once_every=157 once_so=119 once_the=-94
    once_there=-94 once_you=-39 once_you're=-94 once_you've=-94 one=-68 one's=-94 one_=-80
    one_after=-94 one_and=-54 one_deck=-94 one_door=-94 one_flight=-200 one_floor=-154
    one_in=-142 one_is=68 one_more=-113 one_of=-128 one_on=-200 one_side=68 one_step=-200
    one_that=-164 one_too=86 one_two=-94 one_up=-94 one_who=199 one_with=-200 one_you=-200
    ones=67 ones_=86 only=111 only_=199 only_and=27 only_one=-198 only_the=137 onto=-200
    onto_the=-200 ooh=-71 oops=-154 open=-146 open_=-154 open_door=-200 open_doorway=-183
    open_it=-113 open_the=-174 opening=-200 opening_=-94 opening_and=-94 opening_in=-128
    opening_on=-128 opens=-200 opens_on=-94 opera=-42 operational=180 operator=200
    operator's=180 operator_has=119 operators=180 opposite=143 opposite_=113 opposite_of=200
    opposite_the=-198 optical=-42 optional=180 options=-42 or=-49 or_down=52 or_what=-94
    orange=-200 orchids=-42 order=200 order_=200 order_of=200 ordered=180 orders=200 orders_=200
    orders_so=140 orders_you=140 organ=-128 organ_pipes=-94 orientation=-42 origin=-42 other=81
    other_=150 other_end=27 other_hand=200 other_one=-154 other_side=-65 other_way=174
    others=138 otherwise=180 ottoman=-195 ottoman_=-154 ought=200 our=137 ours=-71 out=-52
    out_=103 out_and=-198 out_at=-94 out_by=-183 out_from=-94 out_in=-113 out_into=27
    out_of=-110 out_on=-128 out_onto=-200 out_past=-94 out_the=21 out_through=-200 out_to=-200
    out_turn=-154 outdoor=-71 outer=-42 outeray=180 outline=180 output=180 outrank=180
    outside=-101 outside_=-19 outside_and=-135 outside_it=-113 outside_of=-128 outside_on=-142
    outside_room=-94 outside_the=-200 outside_then=-83 outside_through=-113 oval=-159 oven=-200
    oven_=-200 oven_and=-104 oven_on=-94 over=-76 over_the=-200 over_to=-76 override=164
    overwrite=180 own=200 own_axis=200 owner=200 owner's=-113 owner_of=200 paces=-42 page=180
    paint=-94 painted=38 painting=-200 painting_=-159 painting_and=-83 painting_of=-128
    paintings=-183 paintings_=-164 pair=-154 pair_of=-128 pairs=-42 pajamas=-42 pal=-71 pale=-42
    pallet=-71 pallets=-42 palm=-154 pane=-42 panel=-198 pantry=-200 pantry_=-148 pantry_and=-71
    pantry_door=-113 pantry_with=-83 paper=-113 papers=-42 par=-113 paragraph=180 parallel=-71
    parish=-42 park=-142 parked=-71 parking=-71 parlor=-42 parlour=-42 part=137 part_of=150
    party=-42 pass=-143 pass_2=-104 pass_a=-200 pass_between=-113 pass_four=-94 pass_it=38
    pass_one=-113 pass_something=172 pass_the=-171 pass_three=-183 pass_through=-113
    pass_to=-142 pass_two=-195 pass_under=-94 passage=-198 passage_and=-113 passed=52 passes=-94
    passing=-154 past=-200 past_=109 past_a=-200 past_all=-191 past_both=-128 past_every=-191
    past_four=-128 past_it=-72 past_six=-94 past_the=-200 past_them=-164 past_three=-113
    past_two=-200 pat=-42 patch=-42 path=-16 path_=-94 path_that=86 patience=180 patio=-200
    patio_=-121 patio_and=-200 patio_turn=-71 patrol=-42 pause=52 pay=16 pea=-42 peanuts=-71
    pears=-42 peasy=-42 pebbles=-42 pedestal=-71 peek=-71 peel=-71 pegs=-113 penguin=-113
    people=2 people_sitting=-174 percent=180 perfect=-42 perform=199 pergola=-42 perimeter=180
    permission=180 permit=138 permitted=180 perpendicular=-42 persian=-71 person=200
    person_in=200 person_who=166 personnel=180 petal=-42 peter=180 pew=-191 pew_=-113 pews=-198
    pews_=-94 pews_on=-94 phase=-164 phone=-183 phone_=-113 phone_booth=-128 photo=-71
    photographs=-71 photos=-142 photos_on=-113 piano=-200 piano_=-200 piano_and=-148
    piano_then=-71 pianos=-121 pick=113 picture=-93 picture_=-148 picture_of=-183 pictures=-113
    piece=-42 pillar=-200 pillar_=-174 pillar_and=-113 pillar_turn=-83 pillars=-169
    pillars_and=-128 pillows=-71 pinball=-113 pinball_machine=-113 pinch=-42 ping=-174
    ping_pong=-174 pink=-191 pins=-42 pipes=-154 pit=-113 pitch=-42 pivot=109 place=200
    place_=191 place_where=200 plan=200 plan_=200 plane=-71 planetarium=-42 planets=-71
    planned=180 plant=-200 plant_=-200 plant_and=-200 plant_in=-113 plant_on=-58 plant_take=-58
    plant_turn=-135 planters=-71 plaque=-164 plaster=-42 plastic=-94 plate=138 plates=-113
    play=-71 player=-128 player_=-94 playhouse=-42 playing=-42 playroom=-154 please=164
    please_=23 please_do=200 please_don't=199 please_return=200 please_walk=50 plinth=-42
    plonk=-71 plotter=-71 pls=180 plunge=-174 plunge_pool=-174 plus=-42 po's=-142 pocket=-42
    podium=-113 point=50 point_=38 points=-94 pointy=-42 poke=-42 pole=-42 police=200 policy=180
    polish=-71 pommel=-71 pond=-71 pong=-174 pong_table=-174 pool=-200 pool_=-164 pool_and=-200
    pool_table=-200 pool_with=-94 pop=-113 popcorn=-174 poppet=-42 porch=-200 porch_=-200
    porch_and=-159 porches=180 port=-71 portable=-42 porthole=-113 porthole_=-94 portholes=-71
    portrait=-191 portrait_=-113 portraits=-71 portside=-42 pose=109 position=114 post=-154
    post_=-94 postcards=-71 postcondition=-42 poster=17 pot=-154 pot_=-94 pots=52
    pots_hanging=-94 potted=-200 potted_palm=-128 potted_plant=-200 potted_tree=-128 pottery=-94
    potting=-71 pouffe=-42 poultry=-42 powder=-42 power=152 prams=-42 prayer=-71
    preconditions=-42 prep=-42 present=200 presents=-42 press=-71 pressure=-71 pretend=138
    pretty=-174 previous=200 principal's=-71 principle=180 print=109 printed=200 printer=-174
    printer_=-94 printer_and=-113 printers=-71 prior=-42 priority=-42 privacy=180 private=-113
    privileges=180 prize=-42 proceed=-111 proceed_past=-178 proceed_to=6 projection=-42
    projects=-42 pronto=-42 proof=-71 proud=-71 psst=180 pub=-42 pucker=-42 pull=-42 pulled=-42
    pulpit=-154 pulpit_=-94 pump=-71 pup's=-42 puppet=-113 puppet_theater=-94 purple=-200
    purposes=180 pursuant=180 push=-198 put=129 put_=200 puts=-71 putting=-71 pyjamas=-42 q=-42
    qty=-42 quarter=-71 query=-42 questions=138 queue=138 quick=-154 quickly=-113 quiet=-154
    quietly=-71 quilt=-71 quilts=-42 quite=-42 r=-191 rack=-200 rack_=-200 rack_and=-200
    rack_of=-142 rack_on=-113 rack_with=-113 racks=-148 racks_=-94 radiator=-164 radiator_=-142
    radiators=-113 rail=-191 railing=-200 railing_=-183 railing_and=-142 railing_on=-183
    railing_to=-154 railings=-94 rails=-94 rain=-71 ramp=-200 ramp_=-200 ramp_and=-200
    ramp_on=-94 range=-71 rather=200 rather_than=199 ray=-71 rd=-42 reach=-92 reach_it=-113
    reach_the=-114 reached=199 reached_the=166 reaching=-113 reaching_it=-113 read=200
    read_is=200 read_the=166 read_this=200 reader=109 reading=38 reads=123 ready=-71 real=16
    really=-142 rear=68 rear_door=-94 rearward=-42 rearwards=-42 reason=200 reasons=180
    recall=180 receive=180 reception=-200 reception_=-121 reception_desk=-200 recessed=-42
    recipe=-42 reciprocal=-42 recliner=-71 recliners=-71 record=-113 record_player=-113 red=-200
    red_carpet=-183 red_curtain=-154 red_door=-154 red_fridge=-94 red_line=-94 red_sofa=-113
    reference=-42 reflection=180 reflective=-94 refrain=200 refrigerator=-200 refrigerator_=-200
    refrigerator_and=-83 refrigerator_turn=-58 refuse=180 refused=180 regardless=180
    register=-200 register_=-154 regulation=180 reinstate=180 reject=180 relaid=-42 relax=138
    released=180 relieved=-71 remain=200 remainder=200 remaining=52 remains=138 remember=200
    remember_to=200 remind=-42 remove=180 repeat=86 repeated=138 replace=200 replaced=200
    replacement=180 report=200 request=200 requested=180 requesting=-42 requests=180 require=-42
    required=-71 requirement=-42 requires=200 rescinded=180 research=180 respect=180 rest=200
    rest_=184 rest_of=200 restaurant=-113 restaurant_and=-94 restroom=-71 restrooms=-71
    result=-71 retrace=116 retrace_your=44 return=200 return_to=200 reverse=166 reverse_of=200
    reversed=180 revert=180 revoked=180 revolution=-42 revolving=-183 revolving_door=-183
    rewarded=-42 ride=-128 riding=-42 right=-124 right's=-42 right_=-112 right_a=-94
    right_after=-200 right_again=-198 right_along=-113 right_and=-200 right_angle=-94
    right_around=-148 right_as=-90 right_at=-149 right_before=-31 right_beside=86 right_by=-191
    right_corner=-164 right_down=-94 right_go=-200 right_hand=-200 right_immediately=-113
    right_in=29 right_instead=52 right_into=-200 right_is=27 right_just=-200 right_now=-128
    right_of=-200 right_off=-94 right_on=-128 right_one=-183 right_past=-187 right_right=-164
    right_side=-200 right_so=-2 right_stop=-71 right_take=-94 right_then=-200 right_there=-61
    right_to=23 right_towards=-164 right_turn=-18 right_until=-164 right_up=-128 right_wait=-154
    right_walk=-200 right_wall=-142 right_when=-142 right_with=-113 righto=-42 rightwards=-42
    righty=-42 rim=-42 ring=-94 rink=-42 riser=-42 risers=-42 rises=-42 riverside=-198 road=-94
    robes=-71 robot=77 robotics=180 robots=200 robots_must=200 rock=-42 rocking=-200
    rocking_chair=-198 rocking_horse=-94 rocks=-113 role=180 roll=86 rolled=-128 rolled_up=-94
    roller=-71 rolling=-42 rolls=-42 roman=-71 roof=-154 roof_=-94 room=-105 room's=-71
    room_=-112 room_after=-23 room_and=-200 room_before=150 room_between=-94 room_by=-128
    room_door=-128 room_for=86 room_go=-128 room_has=61 room_is=38 room_on=-200
    room_opposite=-164 room_past=-94 room_straight=-128 room_that=128 room_the=-164
    room_then=-200 room_through=-135 room_to=-198 room_turn=-195 room_using=-187 room_where=-154
    room_which=-94 room_with=-193 room_you=-198 rooms=98 rooms_=109 root=180 rope=-200
    rope_barrier=-113 rotate=69 rotate_twice=184 rotating=180 rotation=68 roughly=-71 round=-19
    round_=200 round_and=16 round_dining=-94 round_it=-113 round_table=-142 round_tables=-113
    round_the=-200 round_to=-113 rounded=-42 rounding=-42 route=200 route_=200 route_and=200
    route_is=200 routes=180 row=-200 row_=-142 row_and=-113 row_of=-200 rowing=-113 rows=-191
    rows_of=-164 rubber=-71 rubbish=-42 rug=-200 rug_=-200 rug_and=-200 rug_ends=-94 rug_in=-164
    rug_to=-83 rule=200 rules=200 run=200 run_lasts=200 runner=-142 runner_rug=-113 running=-71
    runs=-113 rush=-42 s=-42 saddle=-128 saddle_=-94 safe=-94 safest=180 safety=200
    safety_officer=172 said=200 sailor=-42 salad=-113 salon=-113 saloon=-71 same=-49 sandbox=-94
    sanitary=-42 saturn=-71 sauna=-200 sauna_=-121 sauna_and=-121 sauna_go=-83 sausage=-42
    saw=138 say=112 say_hi=-94 say_that=200 saying=38 says=200 says_=200 says_stop=-191
    says_that=200 scale=-200 scale_=-183 scales=-71 scary=-42 school=-113 science=-71
    sconces=-42 scoot=-94 scrap=200 scratch=180 screen=-200 screen_=-200 screen_door=-154
    screens=-164 scroll=-142 scullery=-113 sculpture=-169 sculpture_=-83 sculpture_and=-71
    sculptures=-23 sealed=180 search=138 seashells=-71 seat=-200 seat_=-113 seat_on=-94
    seating=-71 seats=-191 seats_=-113 sec=-42 second=-108 second_=-72 second_door=-35
    second_floor=-113 second_left=-113 second_one=-200 second_right=-148 second_set=-113
    second_turn=109 secondly=-42 seconds=180 section=180 sectional=-94 sector=-42 secure=-94
    security=144 see=-158 see_a=-106 see_an=-159 see_if=-94 see_stairs=-94 see_that=-164
    see_the=-200 see_two=-113 seen=-71 segment=-71 select=-94 sells=-42 send=200 sendorfer=-142
    sense=138 sensor=-42 sent=200 sentence=200 sentences=200 separating=-42 separation=-42
    seriously=180 served=180 server=180 serves=-42 service=166 service_=199 serving=-42
    session=180 set=-18 set_of=-200 sets=-128 sets_of=-128 seven=-113 seventh=-71 sewing=-154
    sewing_machine=-154 shade=-94 shade_=-94 shall=185 shaped=-113 shaped_like=-94 sharp=-133
    sharp_left=-200 sharp_right=-200 sharply=-71 she=200 she's=-42 shed=-94 sheets=-42
    shelf=-200 shelf_=-183 shelf_and=-187 shelf_of=-113 shelf_with=-113 shells=-42 shelves=-200
    shelves_=-128 shelving=-42 shhh=-71 shift=-94 shiny=-183 shiny_black=-94 shiny_floor=-113
    ship=-128 ship's=-42 shipping=180 shoe=-200 shoe_display=-113 shoe_rack=-128 shoe_store=-94
    shoes=-164 shoes_=-128 shop=-200 shop_=-142 shop_and=-94 shop_past=-94 shop_turn=-94
    shopping=-113 shopping_carts=-113 short=-200 short_of=-94 should=91 should_be=-41
    should_go=200 should_not=200 should_now=-142 should_see=-200 should_stop=-142 shoulder=180
    shout=-42 shouted=200 shouts=180 shove=-42 show=109 shower=-200 shower_=-113 shower_and=-121
    shower_room=-164 shower_turn=-71 showers=-154 shredder=-42 shut=200 shut_down=200
    shutdown=180 shutters=-71 shy=-42 side=-127 side_=-144 side_and=-200 side_as=-94
    side_chapel=-94 side_door=-164 side_of=-174 side_to=-113 sideboard=-94 sides=73 sign=-74
    sign_=-54 sign_and=-174 sign_with=-113 signal=180 signed=180 signs=-142 sill=-94 sill_=-94
    silly=-42 silver=-94 simple=-71 since=-142 since_the=-128 singing=-42 single=128
    single_step=169 sink=-200 sink_=-200 sink_and=-154 sink_in=-83 sinks=-198 sinks_=-113
    sinks_and=-154 sir=180 sister=-42 sit=-11 sit_down=109 sit_on=-94 site=184 sits=-142
    sitting=-200 sitting_area=-113 six=-200 six_=-94 sixth=-113 sixty=-42 size=-71 skeleton=-164
    skeleton_=-94 ski=-71 skinny=-113 skip=122 skip_the=77 skipped=180 skirt=-113 skirting=180
    skis=-71 skylight=-164 skylight_=-142 sleep=200 sleeping=-42 sleeps=-42 slide=68 slider=-142
    slides=-42 sliding=-200 sliding_door=-198 sliding_doors=-200 sliding_glass=-94 slight=-200
    slight_left=-200 slight_right=-200 slightly=-200 slightly_left=-200 slightly_right=-200
    slip=-94 slope=-42 sloping=-42 slot=-71 slow=-42 slowly=-164 small=-159 small_door=-164
    small_hallway=-94 small_office=-94 small_room=-94 small_table=-187 smalls=-42 smell=-42
    smells=-42 smelly=-42 smidge=-71 smile=-94 smooth=-42 snack=-113 snail=-71 sneak=-71
    snuggled=-42 so=47 so_be=-94 so_do=187 so_find=-113 so_get=-94 so_go=-198 so_it's=-113
    so_just=-191 so_keep=90 so_let's=-94 so_rotate=119 so_stop=6 so_that=-200 so_that's=-94
    so_the=-164 so_turn=16 so_use=119 so_walk=-72 so_you=-68 so_you're=-164 soak=-42 soccer=-42
    socks=-71 sofa=-115 sofa_=-200 sofa_and=-200 sofa_on=-83 sofas=-113 soffit=-42 soft=-113
    software=180 soldier=-71 some=-38 somebody=104 someone=199 someone's=-42 someone_else=200
    something=200 something_=200 sometimes=-42 somewhere=-113 song=-42 soon=-0 soon_as=-56
    sooner=-42 sorry=-18 sort=-42 sound=-42 source=-42 spa=-169 spa_=-104 space=52
    space_between=-94 span=-42 speaker=109 speakers=-42 speaking=200 special=180 species=-42
    specifically=-42 speed=138 spiders=-71 spin=178 spin_around=128 spin_on=200 spinning=-94
    spiral=-200 spiral_staircase=-191 splits=-198 spoken=180 sports=-42 spot=59 spot_=45
    spot_a=-94 squad=-71 square=2 square_table=-83 squares=-42 squeaks=-42 squeeze=-128
    squirts=-42 squishy=-42 st=-71 stable=-71 stack=-128 stack_of=-128 stacked=-142 staff=16
    staff_only=-164 stage=-200 stage_=-142 stage_and=-113 stage_up=-94 stain=-71 stained=-113
    stained_glass=-113 stair=-174 stair_=-94 staircase=-168 staircase_=-200 staircase_and=-164
    staircase_on=-94 staircases=-71 stairs=-99 stairs_=-60 stairs_all=-113 stairs_and=-133
    stairs_are=-113 stairs_beside=-94 stairs_but=-113 stairs_down=27 stairs_go=-128
    stairs_going=-94 stairs_next=-164 stairs_not=-128 stairs_on=-128 stairs_take=-142
    stairs_that=38 stairs_then=-174 stairs_to=-200 stairs_turn=-200 stairs_up=-113
    stairs_which=-94 stairs_with=-183 stairway=-200 stairway_=-174 stairway_and=-135
    stairway_on=-83 stairwell=-164 stall=-71 stalls=-71 stand=-5 stand_=58 stand_and=-159
    stand_by=43 stand_in=52 stand_next=-159 stand_still=166 stand_then=-58 stand_turn=-94
    stand_with=-200 standard=-42 standing=-113 standing_in=-200 standing_on=-113 stands=-71
    star=-113 star_=-94 starboard=-113 staring=-42 stars=-71 start=93 start_=200 start_at=-128
    start_by=-200 start_in=-174 start_there=-94 started=200 starting=-14 starting_at=-178
    state=-42 station=-200 station_=-94 station_and=-164 stationary=-42 statue=-200 statue_=-200
    statue_and=-148 statue_of=-191 status=180 stay=198 stay_=200 stay_here=200 stay_in=114
    stay_on=-154 stay_put=200 stay_there=114 stay_where=200 staying=-94 stays=-42 steady=-42
    steam=-142 steam_room=-113 steel=-183 steeply=-42 steering=138 step=-12 step_=45 step_and=62
    step_away=-164 step_inside=-94 step_into=-200 step_of=169 step_out=-74 step_over=-200
    step_stop=-83 step_turn=-128 stepping=-113 steps=-52 steps_=6 steps_and=-200 steps_down=-200
    steps_forward=-142 steps_go=-113 steps_going=-94 steps_into=-113 steps_on=-159
    steps_then=-195 steps_to=-200 steward=-42 stick=-42 sticks=-94 still=164 still_=200
    stinky=-42 stone=-200 stone_bench=-94 stone_floor=-94 stone_stairs=-94 stone_steps=-164
    stones=-71 stool=-200 stool_=-200 stool_and=-128 stool_then=-71 stool_with=-94 stools=-200
    stools_=-183 stools_and=-128 stools_to=-71 stools_turn=-83 stoolss=-23 stop=-138 stop_=-92
    stop_1=-174 stop_a=-174 stop_and=30 stop_as=86 stop_at=-200 stop_before=-110
    stop_behind=-200 stop_beside=-200 stop_between=-200 stop_by=-200 stop_facing=-178
    stop_here=94 stop_in=-200 stop_inside=-198 stop_is=199 stop_just=-200 stop_near=-38
    stop_next=-200 stop_now=200 stop_on=-200 stop_once=-164 stop_outside=-200 stop_right=-200
    stop_there=-200 stop_to=-164 stop_under=-200 stop_when=-134 stop_where=50 stop_with=-154
    stopped=109 stopping=50 stopping_=199 stops=-71 store=-174 store_=-128 storey=-42 story=180
    stove=-200 stove_=-200 stove_and=-187 stove_in=-94 stove_past=-94 straight=-200
    straight_=-72 straight_across=-200 straight_ahead=-200 straight_and=-154
    straight_between=-195 straight_down=-200 straight_into=-164 straight_on=-11
    straight_out=-200 straight_past=-200 straight_then=-83 straight_through=-126
    straight_to=-200 straight_until=-200 straight_with=-94 streamers=-71 street=-142
    stretcher=-42 string=138 stringed=-42 strings=-71 strip=-42 striped=-200 striped_blanket=-94
    striped_rug=-113 strips=-42 stripy=-94 stroll=-128 strollers=-42 stuck=199 student=-71
    studio=-94 studio_=-94 study=-200 study_=-164 study_and=-191 stuff=180 stuffed=-113
    stuffed_bear=-113 subheading=-94 subject=-42 success=200 such=-71 sugar=-42 suit=-154
    suit_of=-154 suitcase=-42 suitcases=-42 summer=-42 sump=-42 sun=-195 sun_room=-159
    sundial=-71 sunflowers=-71 sunken=-113 sunny=-42 sunroom=-183 sunroom_=-94 sunshine=-42
    super=-71 supersedes=180 superstar=-42 supervisor=200 support=180 sure=68 surface=-71
    sushi=-42 suspended=180 swan=-42 swap=200 swap_left=200 swapped=-142 sway=-42 sweep=-42
    sweet=-128 sweet_little=-94 sweetheart=-42 sweetie=-42 swimming=-71 swing=-200 swing's=-42
    swing_=-164 swing_and=-113 swinging=-164 swinging_doors=-128 swings=-42 swingy=-42 switch=99
    switched=180 switches=-142 swivel=-94 sworn=-42 system=200 t=-154 t_=-94 t_junction=-94
    ta=-42 tabel=-142 table=-187 table_=-200 table_and=-200 table_around=-71 table_at=-94
    table_between=-94 table_go=-94 table_head=-58 table_in=-159 table_is=52 table_keeping=-128
    table_on=-200 table_so=-135 table_that=-113 table_then=-200 table_to=16 table_turn=-121
    table_walk=-113 table_where=-128 table_with=-200 tables=-54 tables_=-142 tables_with=-94
    tada=-42 tail=-94 take=-37 take_a=-118 take_about=-94 take_it=-183 take_one=-128
    take_the=-66 take_two=52 take_you=-154 taken=199 takes=-42 taking=-71 tall=-200
    tall_chair=-94 taller=-42 tallest=-71 tan=-195 tan_chair=-58 tank=-200 tank_=-200
    tank_and=-169 tank_then=-83 tape=-154 taped=-42 tapestry=-200 tapestry_=-135
    tapestry_and=-83 tapestrys=-23 target=87 task=200 task_=200 tasking=-42 tastes=-42 tea=-128
    teacher=180 teacher's=-142 teacher's_desk=-142 teal=-71 team=199 technician=200
    technician_with=200 teddies=-71 teenager's=-42 teeny=-128 teh=180 telephone=-113
    telescope=-174 telescope_=-154 television=-200 television_=-200 television_and=-83
    television_then=-58 televisions=-23 tell=200 tell_you=200 teller=-113 telling=180 tells=200
    tells_you=200 telly=-71 tempting=-42 ten=173 tent=-71 term=-42 terminal=-42 terminate=-71
    terminates=-71 terminating=-42 terms=180 terrace=-200 terrace_=-142 terrace_and=-94 test=180
    text=200 text_says=200 text_you=157 than=146 than_the=86 thank=200 thank_you=200 thanks=169
    that=97 that's=-200 that's_a=-142 that's_all=-94 that's_at=-94 that's_closest=-94
    that's_got=-128 that's_it=-154 that's_on=-94 that's_shaped=-94 that's_the=-191
    that's_where=-200 that's_your=-142 that_=150 that_and=-113 that_are=184 that_door=-198
    that_follow=172 that_follows=200 that_go=-113 that_goes=113 that_has=-200 that_is=107
    that_it=58 that_looks=38 that_none=200 that_one=-200 that_robots=200 that_room=169
    that_says=-198 that_the=109 that_was=200 that_way=87 that_you=200 the=-49 the_3=-71
    the_administrator=200 the_aisle=-200 the_alarm=-164 the_alcove=-113 the_altar=-198
    the_aquarium=-154 the_arch=-200 the_archway=-200 the_armchair=-174 the_art=-94 the_atm=-94
    the_attic=-200 the_automatic=-142 the_baby=-142 the_back=-153 the_balcony=-200
    the_ballroom=-183 the_bananas=-94 the_banister=52 the_baptistery=-113 the_bar=-200
    the_barbecue=-142 the_barn=-142 the_barrels=-113 the_base=-94 the_basement=68 the_bath=-94
    the_bathroom=-116 the_bathtub=-200 the_bay=-174 the_bead=-94 the_beaded=-94 the_bed=-167
    the_bedroom=-36 the_beds=-128 the_beginning=200 the_bell=-142 the_bench=-200
    the_bicycle=-142 the_bidet=-94 the_big=-200 the_biggest=-94 the_bike=-113 the_bikes=-113
    the_billiard=-113 the_birdbath=-113 the_black=-187 the_blackboard=-128 the_blue=-200
    the_boiler=-174 the_bookcase=-200 the_bookshelf=-178 the_boot=-94 the_boss=52
    the_bottom=-200 the_brass=-94 the_bread=-94 the_break=-94 the_breakfast=-200 the_brick=-191
    the_bridge=-113 the_brochure=-113 the_brown=-200 the_bucket=-113 the_buffet=-128
    the_building=115 the_bulletin=-113 the_bunk=-200 the_bust=-154 the_cabin=-164
    the_cabinet=-183 the_cactus=-142 the_cafe=-128 the_cake=-94 the_candle=-187 the_candles=-128
    the_candy=-94 the_carpet=-200 the_cash=-198 the_ceiling=99 the_cellar=-164 the_center=-164
    the_cereal=-113 the_chair=28 the_chairs=-200 the_chandelier=-200 the_changing=-154
    the_chapel=-94 the_charging=16 the_chart=-113 the_checkout=-94 the_chess=-113 the_chest=-94
    the_chief=200 the_chimney=-94 the_china=-128 the_christmas=-113 the_church=-128
    the_classroom=-154 the_cloakroom=-94 the_clock=-200 the_closed=-174 the_closest=-128
    the_closet=-117 the_coat=-200 the_coats=-113 the_coffee=-200 the_column=-104 the_columns=-94
    the_computer=-113 the_concierge=-113 the_conference=-200 the_confessional=-113
    the_contrary=200 the_control=108 the_copier=-198 the_corner=-200 the_corridor=-200
    the_costumes=-94 the_couch=66 the_counter=-200 the_courtyard=-154 the_crib=-200
    the_curtain=-200 the_curved=-164 the_dance=-128 the_dark=-94 the_dartboard=-142
    the_deck=-200 the_deep=-113 the_deer=-113 the_den=-183 the_description=200 the_desk=-200
    the_desks=-164 the_dining=-200 the_dinosaur=-128 the_direction=52 the_directions=200
    the_dishwasher=-200 the_display=-142 the_distance=-164 the_doctor's=38 the_dog=-142
    the_door=-139 the_doormat=-174 the_doors=-183 the_doorway=-200 the_double=-200
    the_dresser=-200 the_dressing=-191 the_drinking=-113 the_drum=-174 the_drums=-128
    the_dryer=-174 the_easel=-164 the_edge=-200 the_elevator=-200 the_elevators=-164
    the_end=-106 the_engine=-94 the_entrance=-154 the_entryway=-195 the_escalator=-200
    the_exercise=-159 the_exit=-31 the_eye=-113 the_family=-148 the_far=-200 the_fence=-113
    the_fern=-128 the_fifth=-113 the_filing=-113 the_fire=-11 the_fireplace=-200 the_first=-32
    the_fish=-200 the_five=-94 the_floor=-24 the_flower=-174 the_flowers=-113 the_folding=-94
    the_following=200 the_font=-128 the_foosball=-94 the_foot=-200 the_fountain=-200
    the_four=-159 the_fourth=-11 the_foyer=-107 the_freezer=-164 the_french=-200 the_fridge=-200
    the_front=-125 the_fruit=-94 the_full=-94 the_gallery=-154 the_game=-159 the_gap=-128
    the_garage=-82 the_garden=-18 the_gas=-113 the_gate=-200 the_generator=-94 the_giant=-94
    the_gift=-154 the_glass=-176 the_globe=-200 the_goal=200 the_gold=-128 the_grandfather=-178
    the_grass=-113 the_gray=-195 the_green=-200 the_grey=-174 the_grill=-200 the_guest=-200
    the_guitar=-113 the_gumball=-113 the_gym=-200 the_half=-113 the_hall=-200 the_hallway=-200
    the_handrail=-113 the_harp=-191 the_harpsichord=-113 the_hat=-142 the_hatch=-154 the_hay=-94
    the_head=199 the_heavy=-94 the_hedge=-94 the_high=-174 the_hooks=-94 the_horse=-128
    the_hospital=6 the_hot=-200 the_hotel=-142 the_house=64 the_ice=-200 the_inner=-94
    the_iron=-154 the_ironing=-174 the_island=-183 the_jacuzzi=-135 the_jukebox=-142
    the_keyboard=-94 the_kitchen=-89 the_kitchenette=-113 the_l=-94 the_ladder=-200 the_lady=-94
    the_lamp=-200 the_landing=-200 the_large=-200 the_last=40 the_laundry=-200 the_leather=-200
    the_left=-200 the_leftmost=-94 the_letter=109 the_library=-200 the_life=-154
    the_lifeboat=-94 the_lifeboats=-113 the_lifebuoy=-94 the_lifeguard=-94 the_lift=-3
    the_light=-142 the_linen=-200 the_list=200 the_little=-200 the_living=-61 the_lobby=-200
    the_locker=-94 the_lockers=-200 the_loft=-142 the_long=-123 the_lounge=-200 the_low=-94
    the_lower=-113 the_lunch=-94 the_machine=-183 the_mailbox=-154 the_mailboxes=-174
    the_main=-128 the_mannequin=-142 the_map=200 the_marble=-200 the_massage=-191
    the_master=-154 the_mat=-200 the_metal=-200 the_microwave=-183 the_middle=-127 the_milk=-94
    the_mirror=-200 the_mirrored=-113 the_mirrors=-142 the_mop=-142 the_moving=-128 the_mud=-178
    the_museum=-113 the_music=-128 the_narrow=-154 the_nave=-94 the_nearest=-30
    the_newspapers=-113 the_next=58 the_nightstand=-174 the_notice=-94 the_number=38
    the_nurse's=-174 the_nursery=-200 the_nurses=-128 the_object=200 the_office=-200 the_old=77
    the_one=-42 the_ones=-94 the_open=-200 the_opening=-174 the_opposite=200 the_orange=-191
    the_organ=-128 the_other=70 the_ottoman=-164 the_outside=-128 the_oval=-94 the_oven=-200
    the_owner=200 the_painting=-159 the_pantry=-200 the_passage=-128 the_path=36 the_patio=-200
    the_people=-2 the_person=200 the_pews=-164 the_phone=-154 the_photos=-128 the_piano=-200
    the_picture=21 the_pictures=-94 the_pillar=-198 the_pinball=-113 the_ping=-142 the_pink=-135
    the_place=200 the_plan=200 the_plant=-200 the_plaque=-164 the_playroom=-142 the_plunge=-164
    the_podium=-113 the_police=200 the_pool=-200 the_popcorn=-128 the_porch=-200
    the_portrait=-154 the_poster=77 the_potted=-200 the_pottery=-94 the_pretty=-94
    the_printer=-174 the_pulpit=-142 the_puppet=-113 the_purple=-200 the_rack=-174
    the_radiator=-164 the_rail=-183 the_railing=-200 the_ramp=-200 the_reading=-113
    the_reception=-200 the_record=-113 the_red=-200 the_refrigerator=-200 the_remaining=52
    the_rest=200 the_restaurant=-113 the_reverse=200 the_revolving=-164 the_right=-199
    the_robot=-191 the_rocking=-191 the_roof=-113 the_room=-152 the_rope=-164 the_round=-200
    the_route=200 the_row=-200 the_rowing=-94 the_rows=-94 the_rug=-200 the_run=200
    the_safety=200 the_salad=-94 the_same=-31 the_sandbox=-94 the_sauna=-200 the_scale=-200
    the_school=-94 the_screen=-174 the_scullery=-113 the_sculpture=-113 the_second=-162
    the_sentence=200 the_service=109 the_set=-128 the_sewing=-154 the_shelf=-200
    the_shelves=-128 the_shiny=-142 the_shoe=-200 the_shoes=-128 the_shop=-183 the_shopping=-113
    the_short=-128 the_shower=-200 the_showers=-154 the_side=-200 the_sign=-19 the_sill=-94
    the_silver=-94 the_sink=-200 the_sinks=-154 the_site=184 the_sitting=-113 the_sixth=-113
    the_skeleton=-94 the_skylight=-142 the_sliding=-200 the_small=-200 the_snack=-94
    the_sofa=-30 the_spa=-159 the_space=-94 the_speaker=109 the_spiral=-200 the_spot=187
    the_square=-83 the_stack=-113 the_stacked=-128 the_stage=-200 the_stained=-113
    the_staircase=-200 the_stairs=-86 the_stairway=-200 the_start=200 the_statue=-200
    the_steam=-142 the_steel=-113 the_steps=-136 the_stone=-200 the_stool=-169 the_stools=-113
    the_stop=199 the_store=-94 the_stove=-200 the_striped=-200 the_study=-200 the_suit=-142
    the_sun=-187 the_sunken=-94 the_sunroom=-164 the_supervisor=200 the_swing=-200
    the_swinging=-154 the_t=-154 the_table=-44 the_tables=-142 the_tall=-200 the_tan=-148
    the_tape=-94 the_tapestry=-135 the_task=200 the_tea=-113 the_teacher's=-142
    the_telephone=-94 the_telescope=-174 the_television=-195 the_terrace=-191 the_text=200
    the_theater=-191 the_third=-170 the_three=-200 the_threshold=-198 the_throne=-164
    the_ticket=-183 the_tile=-128 the_tiles=-113 the_tiny=-128 the_toilet=-35 the_toilets=-94
    the_top=-200 the_towel=-183 the_towels=-113 the_tower=-113 the_toy=-142 the_trash=-148
    the_treadmill=-200 the_treadmills=-142 the_tree=-174 the_trip=200 the_trophies=-94
    the_trophy=-174 the_trunk=-113 the_tub=-200 the_turns=200 the_turnstile=-154 the_tv=-200
    the_two=-136 the_typewriter=-94 the_umbrella=-200 the_unit=200 the_user=200 the_utility=-148
    the_vacuum=-113 the_vanity=-191 the_vase=-200 the_velvet=-94 the_vending=-200 the_very=16
    the_vestibule=-94 the_volcano=-94 the_waiting=-121 the_walk=200 the_wall=-58 the_walls=68
    the_wardrobe=-200 the_washer=-159 the_washing=-200 the_water=-200 the_way=-4 the_weight=-128
    the_well=-128 the_whale=-94 the_wheelchair=-94 the_while=196 the_white=-200
    the_whiteboard=-200 the_whole=132 the_wicker=-195 the_wigs=-113 the_window=-200
    the_windows=-164 the_wine=-200 the_wobbly=-94 the_wood=-94 the_wooden=-200 the_word=166
    the_words=200 the_workbench=-142 the_wrong=200 the_yard=-142 the_yellow=-200 theater=-200
    theater_room=-154 theater_with=-94 theatre=-94 their=184 them=-48 them_=-35 them_all=109
    them_and=-183 them_on=-128 them_to=-154 themselves=-71 then=-200 then_a=-183 then_after=-83
    then_another=-113 then_as=-83 then_at=-142 then_bear=-104 then_climb=-104 then_come=-113
    then_continue=-121 then_cross=-200 then_descend=-121 then_down=-94 then_enter=-142
    then_follow=-195 then_go=-200 then_hang=-113 then_head=-174 then_immediately=-113
    then_in=-94 then_it's=-191 then_keep=-174 then_left=-200 then_look=-94 then_make=-104
    then_move=-121 then_once=-121 then_out=-183 then_pass=-200 then_past=-200 then_proceed=-164
    then_right=-200 then_slightly=-94 then_stand=-71 then_step=-159 then_stop=-200
    then_straight=-94 then_take=-200 then_that=-94 then_the=-154 then_there's=-183
    then_through=-128 then_to=-113 then_turn=-200 then_up=-113 then_veer=-71 then_wait=-200
    then_walk=-200 then_when=-121 then_you=-200 then_you'll=-128 then_you're=-164 there=-53
    there'll=-113 there'll_be=-113 there's=-200 there's_a=-200 there's_the=-183 there_=-65
    there_and=-60 there_are=-46 there_but=-94 there_is=16 there_make=-94 there_should=-174
    there_so=-128 there_take=-94 there_turn=-113 there_will=-198 there_without=-94 there_you=-94
    thereafter=-42 thereof=-42 theres=-42 these=200 these_commands=200 they=200 they're=-183
    they've=-71 they_are=200 they_turn=-94 they_were=200 thick=-42 thin=-94 thing=-12 thing_=-94
    thing_is=27 thing_number=-94 thing_you=27 things=199 think=137 think_of=169 third=-188
    third_=-191 third_desk=-94 third_door=-25 third_right=-104 third_row=-142 third_window=-142
    thirdly=-42 this=200 this_=200 this_at=200 this_building=200 this_house=200 this_is=200
    this_one=36 this_room=16 this_route=200 this_run=200 this_says=200 this_step=128
    this_task=200 this_text=200 those=-200 those_and=-94 though=-128 three=-127 three_=-128
    three_doors=-183 three_is=-94 three_o'clock=-94 three_stairs=-148 three_stairway=-58
    three_steps=-200 threshold=-198 threshold_and=-198 throne=-191 throne_=-113 throne_and=-128
    through=-200 through_=-183 through_90=-94 through_a=-94 through_and=-154 through_door=-94
    through_it=-81 through_that=-191 through_the=-200 through_there=-94 throughout=138 throw=200
    thru=-94 thumping=-42 tick=-42 ticked=180 ticket=-200 ticket_booth=-113 ticket_machine=-113
    ticks=-42 tied=-71 tiger=-71 tight=-94 tile=-200 tiled=-71 tiles=-183 tiles_=-128 till=-200
    till_the=-200 till_you=-200 time=178 time_and=-113 time_you=200 times=141 times_=199
    tinsel=-71 tiny=-200 tiny_bit=-94 tiny_chairs=-94 tiptoe=-94 titchy=-42 to=-15 to_a=-200
    to_an=-164 to_be=200 to_begin=-94 to_carry=200 to_disregard=200 to_do=101 to_drop=140
    to_end=200 to_face=-200 to_find=113 to_follow=199 to_gate=-113 to_get=-198 to_go=90
    to_it=-150 to_its=-23 to_keep=-113 to_leave=200 to_look=-198 to_move=199 to_open=-142
    to_pass=-142 to_read=157 to_return=200 to_say=-94 to_see=-94 to_stand=-94 to_stop=115
    to_take=121 to_tell=200 to_that=-128 to_the=-117 to_turn=-49 to_undo=119 to_wait=109
    to_walk=191 to_where=159 to_you=200 to_your=-69 tock=-42 today=200 today's=-154 today_=200
    toddle=-71 todo=180 toes=-71 together=-113 toilet=-58 toilet_=58 toilet_ahead=-58
    toilet_and=-200 toilets=-94 told=200 told_me=200 told_to=200 tolerance=-42 tomatoes=-71
    tomb=-71 tomorrow=180 too=79 too_=125 took=-42 tool=-94 tool_bench=-94 toolbox=-42 tools=-71
    top=-200 top_=-200 top_and=6 top_go=-94 top_of=-200 top_turn=-113 top_you'll=-94 toss=180
    touch=-154 touch_the=-113 touching=180 toward=-200 toward_the=-200 towards=-132
    towards_it=-94 towards_the=-189 towel=-200 towel_=-113 towel_rack=-191 towels=-191
    towels_=-174 tower=-164 toy=-198 toy_chest=-113 toys=-113 trace=180 track=-94 tractor=-94
    tractor_=-94 trade=180 train=-128 trains=-71 trajectory=-42 trampoline=-71 transition=-42
    translate=-42 translating=180 translation=-71 trap=200 trash=-198 trash_can=-198 travel=147
    travels=-42 traverse=-94 tray=-42 tread=-42 treadmill=-200 treadmill_=-198
    treadmill_and=-113 treadmill_turn=-58 treadmills=-164 treadmills_=-94 treads=-113
    treasure=-42 treat=200 treat_all=200 treat_the=200 tree=-200 tree_=-198 tree_and=-113
    treehouse=-71 trees=-71 trestle=-71 trip=200 trolley=-42 trolleys=-71 trophies=-128
    trophies_=-94 trophy=-191 trophy_cabinet=-113 trophy_case=-154 trot=-42 trotting=-42
    trough=-71 trucks=-42 true=180 trun=-142 trunk=-113 trust=200 try=-94 tub=-200 tub_=-200
    tub_and=-142 tub_to=-83 tucked=-42 tulips=-71 tumble=-42 tummy=-42 tune=-71 tuner=-42
    tunr=180 turn=-83 turn_=105 turn_90=-200 turn_and=52 turn_around=-42 turn_at=-142
    turn_away=99 turn_back=200 turn_go=109 turn_into=-128 turn_is=200 turn_left=-200
    turn_right=-170 turn_round=16 turn_sharp=-198 turn_slightly=-200 turn_so=-94 turn_to=-200
    turn_toward=-94 turn_until=-94 turn_your=-200 turned=-42 turning=38 turning_on=157 turns=200
    turns_=200 turnstile=-183 turnstile_=-113 turnstile_and=-94 turnstiles=-71 tv=-200 tv_=-200
    tv_and=-142 twang=-42 twelve=-198 twelve_=-94 twice=116 twice_=109 twice_without=184
    twin=-71 twirl=200 twirl_in=200 twist=-42 twit=-42 two=-115 two_=113 two_beds=-94
    two_bookshelves=-94 two_computer=-113 two_couches=-94 two_doors=-200 two_flights=-164
    two_floors=-142 two_hallways=-94 two_long=-113 two_paintings=-94 two_pillars=-113
    two_rooms=-142 two_rows=-113 two_sinks=-113 two_steps=-23 two_three=-94 type=-71 typed=180
    typewriter=-113 typewriter_=-94 typing=138 u=-200 u_turn=-200 uh=-142 um=-164 umbrella=-200
    umbrella_=-94 umbrella_stand=-200 under=-65 under_it=-164 under_the=-197 underneath=68
    understand=180 understood=180 undo=200 undo_what=200 unicorn=-71 uniform=-42 unit=200
    unit_shall=199 units=200 unless=180 unlit=-42 unspecified=-42 until=-25 until_=87
    until_it=-191 until_the=-12 until_you=-103 until_you're=-183 unusual=-42 up=-111 up_=31
    up_a=-142 up_all=-200 up_and=-31 up_at=-94 up_both=-142 up_by=-94 up_in=16 up_it=-128
    up_one=-200 up_or=68 up_the=-200 up_them=-198 up_there=169 up_those=-113 up_three=-200
    up_to=-200 up_two=-200 up_with=86 update=200 updated=180 upholstery=-42 upon=-42 upper=-42
    ups=-71 upside=138 upstairs=29 upstairs_=113 upstairs_in=-113 upwards=-42 urer=180 urn=-71
    us=87 us_=-94 use=105 use_the=62 used=68 used_to=-94 user=200 user's=180 using=-187
    using_the=-187 usually=-42 utility=-148 utility_room=-148 vacuum=-183 vacuum_cleaner=-128
    valid=200 van=-42 vanity=-200 vanity_=-71 vanity_and=-135 vanitys=-23 vase=-200 vase_=-195
    vase_of=-94 vase_on=-135 vases=-164 vault=-113 vector=-42 veer=-200 veer_a=-94
    veer_left=-142 veer_right=-104 veering=-42 vegetables=-42 vehicle=-42 velocity=-42
    velvet=-94 velvet_rope=-94 vending=-200 vending_machine=-200 veranda=-71 verb=200
    verification=-42 version=180 vertical=-71 very=-38 very_first=109 vessel's=-42 vestibule=-94
    vestry=-71 vests=-42 via=-191 via_the=-154 view=-174 view_=-94 vineyard=-42 vise=-71
    visit=-94 visually=-42 voice=200 void=200 void_=200 void_so=119 voids=180 volcano=-94
    voted=180 w=-142 waffle=-71 waist=-42 wait=-46 wait_=-22 wait_at=-200 wait_beside=-154
    wait_by=-117 wait_for=166 wait_here=96 wait_in=-200 wait_just=-178 wait_near=-187
    wait_next=-200 wait_outside=114 wait_there=-200 wait_under=-164 waiting=-35
    waiting_area=-135 waiting_room=-94 wake=-42 wakes=180 walk=-127 walk_=200 walk_3=-113
    walk_a=-159 walk_across=-200 walk_ahead=-164 walk_all=-142 walk_along=-169
    walk_alongside=-200 walk_around=-200 walk_away=-18 walk_back=184 walk_behind=-94
    walk_beside=-94 walk_between=-200 walk_by=-200 walk_down=-200 walk_forward=-200
    walk_from=-142 walk_in=19 walk_inside=-200 walk_into=-68 walk_on=-200 walk_out=-133
    walk_over=-128 walk_past=-200 walk_round=-94 walk_straight=-200 walk_the=-11
    walk_through=-200 walk_to=-139 walk_toward=-174 walk_towards=-70 walk_under=-200
    walk_until=-200 walk_up=-200 walked=138 walking=13 walking_=52 walking_past=-200 walks=200
    walkway=-191 walkway_to=-113 wall=-58 wall_=-124 wall_and=-49 wall_ends=-94 wall_of=86
    wall_on=-43 wall_past=-113 wall_that=109 wall_that's=-94 wall_to=38 wall_with=-183
    wallpaper=-94 walls=-7 walls_=43 walls_and=-113 walnut=-42 wander=68 want=-69 want_=-154
    want_the=-200 want_to=-200 want_you=67 wanted=109 wants=200 wants_you=200 ward=86
    wardrobe=-200 wardrobe_=-200 wardrobe_and=-104 warm=-94 warmer=-71 warn=-42 warranty=180
    was=200 wash=-94 washer=-200 washer_=-135 washer_and=-104 washing=-200 washing_machine=-200
    washing_machines=-83 wasn't=-42 wasteful=-42 watch=-164 watches=-42 watching=-42 water=-200
    water_cooler=-200 water_fountain=-174 water_heater=-128 wave=-154 waxed=-42 way=53 way_=140
    way_around=-113 way_down=-198 way_into=-94 way_of=-195 way_out=-128 way_over=-94
    way_round=200 way_through=-94 way_to=-66 way_up=-94 way_you=99 waypoint=128 we=92 we'd=-42
    we'll=-164 we're=-18 we're_going=-128 we're_not=86 we've=86 we_can=-94 wearing=-42 weave=-42
    weaving=-42 wedding=-71 wedge=-42 wee=-71 weighing=-71 weight=-142 weight_bench=-94
    weight_rack=-94 weights=-71 welcome=-128 welcoming=-42 well=29 well_=-142 wellies=-71
    went=-174 were=200 were_mirrored=200 western=-42 westward=-42 wet=86 whale=-113 what=200
    what_=184 what_is=200 what_it=199 what_the=200 what_they=199 what_this=200 what_you=200
    whatever=200 whatever_is=200 wheee=-42 wheel=52 wheel_=86 wheelbarrow=-71 wheelchair=-94
    wheelchairs=-113 wheels=137 wheels_=52 when=-115 when_the=-11 when_you=-129 when_you're=-200
    when_you've=-113 whenever=200 whenever_you=200 where=85 where_a=169 where_it=180
    where_people=-128 where_the=-200 where_there's=-94 where_they=177 where_you=166
    where_you'll=-94 wherever=200 wherever_it=200 which=-33 which_has=-128 which_is=-200
    which_you=147 whichever=-113 while=200 while_=184 whirl=180 whisky=-42 whispered=180
    white=-200 white_door=-183 white_tiles=-113 white_towels=-113 whiteboard=-200
    whiteboard_=-174 whiteboard_turn=-94 whizz=-71 who=200 whoa=-42 whoever=200 whole=94
    whom=180 whoopsie=-42 whopping=-42 whose=-71 why=-42 wicker=-200 wicker_bench=-83 wide=-71
    wider=-142 width=138 wigs=-113 will=-58 will_be=-58 will_see=-200 willow=-71 win=-71
    winch=-71 winders=-42 window=-200 window's=-42 window_=-200 window_and=-55 window_at=-128
    window_in=-121 window_is=-128 window_seat=-164 window_then=-94 window_turn=-121
    window_with=-94 windows=-200 windows_=-198 windows_and=-94 windows_on=-128 windowsill=-42
    wine=-200 wine_cellar=-154 wine_fridge=-113 wine_rack=-200 wing=-42 wink=-71 winner=-42
    wipe=180 wishing=-71 with=-110 with_a=-198 with_all=-128 with_an=-113 with_flowers=-94
    with_full=184 with_glass=-128 with_green=-94 with_it=86 with_lots=-142 with_no=-113
    with_round=-113 with_the=-123 with_three=-128 with_two=-200 with_windows=-113 with_your=-0
    withdrawn=200 withdrawn_this=140 within=77 without=-6 without_entering=-164
    without_going=-174 without_moving=184 without_stopping=109 witness=-71 wlak=-142 wobbly=-113
    woke=180 woman=-113 women=-42 won't=-42 wonderful=-42 wood=-200 wood_stove=-128 wooden=-200
    wooden_bench=-94 wooden_door=-200 wooden_floor=-191 wooden_pews=-113 wooden_stairs=-94
    wooden_table=-142 word=200 words=200 work=180 workbench=-154 workbench_=-94 working=-71
    workshop=-71 worry=-71 would=87 would_you=-142 wouldn't=-42 wow=-71 wreath=-113
    wristwatch=-42 write=180 written=200 written_=200 written_next=200 wrong=200 wrong_way=200
    wrote=200 x=184 xylophone=-71 yard=-142 yard_=-113 yaw=109 years=-42 yell=-42 yellow=-200
    yellow_line=-142 yellow_lines=-94 yep=-42 yes=-71 yet=-71 yew=-42 yo=180 yoga=-71 yonder=-42
    you=59 you'd=-71 you'll=-200 you'll_be=-200 you'll_come=-191 you'll_find=-191 you'll_go=-94
    you'll_notice=-94 you'll_pass=-164 you'll_see=-200 you'll_spot=-94 you'll_stop=-94
    you'll_want=-183 you're=-200 you're_at=-200 you're_done=-183 you're_facing=-128
    you're_going=-200 you're_in=-200 you're_looking=-174 you're_not=86 you're_out=-94
    you're_outside=-113 you're_standing=-183 you're_there=-183 you've=-54 you've_gone=-142
    you've_got=-128 you_=71 you_and=2 you_are=95 you_at=-113 you_began=200 you_begin=113
    you_bump=-128 you_came=27 you_can=-43 you_can't=-31 you_come=-95 you_did=200 you_do=200
    you_don't=-174 you_enter=-169 you_find=-113 you_for=199 you_get=-151 you_go=-165
    you_have=126 you_hit=68 you_hold=109 you_in=-113 you_into=-94 you_is=109 you_just=-2
    you_leave=128 you_make=109 you_may=52 you_might=-113 you_must=200 you_need=49 you_out=86
    you_pass=19 you_please=-94 you_reach=-185 you_read=200 you_see=-73 you_shall=-94
    you_should=68 you_so=169 you_stand=153 you_stop=-200 you_take=-174 you_that=200 you_the=199
    you_then=-83 you_to=200 you_turn=59 you_undo=119 you_up=169 you_wait=-113 you_walk=-7
    you_want=-200 you_were=200 you_will=-200 your=19 your_back=-200 your_destination=-142
    your_developer=200 your_feet=-94 your_head=86 your_left=-200 your_mission=109
    your_operator=200 your_orders=200 your_own=200 your_right=-200 your_second=-94 your_steps=44
    your_stop=-94 your_stopping=-142 your_way=-200 your_wheels=200 yours=68 yourself=26
    yourself_and=-94 yourself_at=-94 yourself_in=-113 yummy=-42 zero=68 zone=-142
    """
)
WORDS = {term: int(odds) / 100 for term, odds in (w.split("=") for w in _WORDS)}
