"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -0.718,
    "orders": 0.382,
    "text": 0.630,
    "annul": 0.238,
    "invert": -0.058,
    "case": 0.585,
    "halt": 0.286,
    "machine": 0.289,
    "role": 0.233,
    "authority": 0.422,
    "haste": -0.095,
    "if": -0.098,
    "me": -0.158,
    "you": 0.128,
    "third": 0.294,
    "past": 0.120,
    "not": 0.072,
    "here": -0.012,
    "time": 0.274,
    "go": 0.076,
    "has orders": 0.278,
    "has text": 0.089,
    "has annul": 0.238,
    "has invert": 0.025,
    "has case": 0.980,
    "has halt": -0.186,
    "has machine": 0.189,
    "has role": 0.306,
    "has authority": 0.372,
    "has haste": -0.091,
    "has if": 0.201,
    "has me": 0.169,
    "has you": -0.317,
    "has third": 0.083,
    "has past": 0.331,
    "has not": -0.049,
    "has here": -0.330,
    "has time": 0.218,
    "has go": 0.274,
    "hidden": 0.248,
    "alike": 2.713,
    "wide": 1.434,
    "spelled": 2.267,
    "leet": 2.399,
    "code": 0.106,
    "cipher": 2.197,
    "unknown": 1.296,
    "alien": 0.237,
    "foreign letters": 0.255,
    "late verb": 0.116,
    "no verb": 0.281,
    "on route": -0.020,
    "other things": 0.283,
    "nothing": 0.330,
    "turns": 0.056,
    "places": -0.054,
    "no place": 0.889,
    "length": 0.425,
    "short": -0.394,
    "commas": -0.492,
    "asks": 0.290,
    "exclaims": 0.307,
    "quoted": 1.217,
    "quote in": -0.197,
    "markup": 2.907,
    "role of": -0.064,
    "reported": 0.061,
    "self": 0.305,
    "about": 0.998,
    "back to text": -0.404,
    "elsewhere": -0.119,
    "annul orders": 0.125,
    "invert orders": 0.694,
    "case orders": 0.072,
    "not orders": 0.048,
    "halt nowhere": -0.324,
    "halt here": 0.385,
    "not go": 0.051,
    "both sides": 0.645,
    "case not": -0.308,
    "case go": 0.538,
    "case halt": 0.293,
    "me past": 0.052,
    "third past": -0.166,
    "you role": 0.087,
    "authority said": 0.308,
    "machine you": 0.216,
    "me no place": -0.143,
    "past no you": 0.237,
    "annul place": -0.093,
    "not place": 0.422,
    "if place": -0.428,
    "words": 0.801,
    "pairs": 0.562,
    "worst words": 0.022,
    "best words": 0.603,
}
CONTEXT: dict[str, float] = {
    "bias": 0.668,
    "own": 0.864,
    "first": -0.839,
    "last": 0.070,
    "stops early": 1.463,
    "stops before all": 0.384,
    "denies the rest": -0.291,
    "repeats the rest": -0.455,
    "neighbour": 0.960,
    "neighbours": 1.631,
    "alone": -1.284,
    "most": -2.040,
}
PART: dict[str, float] = {
    "bias": -1.208,
    "whole": -0.077,
    "orders": 0.134,
    "text": 0.489,
    "annul": 0.477,
    "invert": 0.229,
    "case": 0.432,
    "halt": 0.621,
    "machine": 0.576,
    "role": 0.116,
    "authority": 0.752,
    "haste": 0.041,
    "if": -0.255,
    "me": -0.952,
    "you": -0.122,
    "third": 0.025,
    "past": 0.023,
    "not": -0.334,
    "here": 0.002,
    "time": 0.010,
    "go": 0.393,
    "has orders": 0.032,
    "has text": 0.564,
    "has annul": 0.469,
    "has invert": 0.229,
    "has case": 0.635,
    "has halt": 0.348,
    "has machine": 0.576,
    "has role": 0.116,
    "has authority": 0.752,
    "has haste": 0.041,
    "has if": -0.093,
    "has me": -0.784,
    "has you": -0.375,
    "has third": 0.286,
    "has past": 0.111,
    "has not": -0.224,
    "has here": -0.581,
    "has time": 0.057,
    "has go": -0.228,
    "hidden": 2.216,
    "alike": 3.678,
    "wide": 0.000,
    "spelled": 0.620,
    "leet": 3.215,
    "code": 0.000,
    "cipher": 2.563,
    "unknown": 1.274,
    "alien": 0.512,
    "foreign letters": 0.300,
    "late verb": -0.153,
    "no verb": -0.592,
    "on route": 0.250,
    "other things": -0.234,
    "nothing": 0.266,
    "turns": 0.464,
    "places": -0.177,
    "no place": 0.043,
    "length": -0.459,
    "short": -0.307,
    "commas": 1.439,
    "asks": -0.782,
    "exclaims": -0.656,
    "quoted": 0.836,
    "quote in": 2.155,
    "markup": 0.000,
    "role of": -0.066,
    "reported": 0.324,
    "self": -0.182,
    "about": 0.424,
    "back to text": -0.215,
    "elsewhere": 0.954,
    "annul orders": 0.554,
    "invert orders": 0.851,
    "case orders": 0.223,
    "not orders": 0.280,
    "halt nowhere": 0.442,
    "halt here": 0.117,
    "not go": 0.400,
    "both sides": 1.038,
    "case not": 0.156,
    "case go": 0.328,
    "case halt": 0.098,
    "me past": -0.100,
    "third past": 0.216,
    "you role": -0.159,
    "authority said": 0.256,
    "machine you": 0.242,
    "me no place": -0.323,
    "past no you": -0.086,
    "annul place": 0.094,
    "not place": 0.479,
    "if place": -0.040,
    "words": 1.352,
    "pairs": 0.990,
    "worst words": -0.093,
    "best words": -0.625,
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
    0=90 07=172 1=-200 10=-142 12=-46 120=-42 13=172 135=-42 14=-42 15=-42 16=-42 18=-42
    180=-165 180_degrees=-165 1_m=-113 2=-200 20=-72 204=-142 214=-72 270=-42 2_m=-198
    2_meters=-113 2_nd=-94 3=-200 30=-94 306=-72 308=-42 310=-42 3_5=-165 3_is=-94 3_m=-94
    3_meters=-113 3_step=-72 4=6 408=-42 45=-72 4_=-42 4_m=-174 4_stop=-142 5=-200 5_m=-113
    5_meters=-113 6=-94 64=172 7=-113 7741=172 8=-42 9=-154 90=-200 90_degrees=-200 9_m=-113
    _=200 _1=-142 _2=-94 _3=-142 _4=-94 _a=121 _action=190 _actually=119 _advance=-128 _after=8
    _all=200 _alright=90 _always=194 _and=-137 _anyway=-26 _are=121 _as=166 _ascend=-94
    _assistant=200 _at=-61 _back=-198 _be=-42 _bear=-200 _bedroom=-94 _before=50 _begin=-15
    _behind=-113 _between=30 _beyond=-94 _bottom=-113 _bound=-94 _bullet=-94 _but=133 _by=200
    _can=15 _cancel=200 _climb=-200 _come=-200 _consider=190 _continue=-87 _could=11 _count=-94
    _cross=-200 _descend=-148 _disregard=161 _do=115 _don't=6 _door=-165 _down=-19 _each=187
    _end=49 _enter=-200 _every=173 _everything=156 _exit=-200 _face=-89 _facing=-200 _find=-200
    _first=-170 _follow=-113 _for=200 _forget=126 _from=-24 _front=78 _get=-101 _go=-200
    _good=169 _guess=90 _hallway=-94 _halt=88 _hang=-113 _he=90 _head=6 _heading=-113 _hello=200
    _here=-66 _here's=15 _hey=153 _hi=200 _hold=10 _how's=163 _i=133 _i'd=140 _i'll=170 _i'm=112
    _i've=-8 _if=106 _ignore=120 _imagine=122 _in=63 _inside=-113 _instead=-200 _into=-113
    _is=200 _it=123 _it'll=-113 _it's=84 _job=-113 _just=49 _keep=-89 _kindly=200 _ladder=-94
    _lap=-94 _leave=-188 _left=-29 _leg=-142 _let's=6 _line=-128 _locate=-113 _look=-178
    _make=-151 _message=200 _move=-200 _my=187 _never=200 _new=200 _next=-200 _no=164 _nobody=52
    _not=-57 _nothing=200 _notice=200 _now=-143 _objective=-94 _of=-94 _off=-8 _oh=200
    _okay=-107 _on=-99 _once=-28 _one=-67 _only=153 _open=-94 _our=200 _out=-200 _override=90
    _par=-113 _pass=-200 _past=-200 _perform=190 _phase=-142 _plan=-94 _please=200 _proceed=-200
    _quick=-94 _read=200 _remain=119 _remember=200 _return=119 _reverse=-19 _right=-174
    _rotate=-94 _route=-165 _say=152 _second=-174 _see=-183 _sharp=-94 _sit=100 _skip=95
    _slide=100 _so=-20 _somebody=200 _sorry=99 _spin=43 _stage=-113 _stairs=-165 _stand=-58
    _start=-200 _starting=-179 _stay=126 _step=-200 _stop=-185 _straight=-200 _swap=200
    _swing=-94 _switch=90 _system=200 _take=-80 _task=197 _tell=163 _thank=200 _that=124
    _that's=-76 _the=136 _then=-200 _there=4 _there'll=-94 _there's=-154 _they=113 _thing=-94
    _third=-128 _this=198 _three=4 _through=-128 _to=-5 _train=-94 _treat=200 _turn=-146
    _two=-73 _under=200 _until=200 _up=-200 _use=-183 _user=200 _veer=-183 _wait=-89 _walk=-200
    _we=133 _we'll=-128 _we're=-42 _we've=100 _well=90 _what=161 _whatever=200 _when=-48
    _whenever=178 _where=95 _with=-76 _without=-191 _would=15 _x=200 _yeah=163 _you=9
    _you'll=-198 _you're=-200 _your=117 a=-28 a_balcony=-84 a_bathroom=-195 a_bathtub=-26
    a_bear=15 a_bed=-200 a_bedroom=-113 a_bench=-62 a_big=-200 a_bit=4 a_black=-159 a_blue=-78
    a_bookcase=-56 a_bookshelf=-94 a_bowl=-113 a_brown=-142 a_bunch=-94 a_cabinet=-72 a_cat=100
    a_chair=5 a_chandelier=15 a_chapel=-94 a_circle=173 a_closed=-94 a_closet=-121 a_comfy=-94
    a_couch=18 a_couple=-198 a_cross=-94 a_curtain=-104 a_cushion=-174 a_desk=-200 a_dining=-104
    a_dog=-94 a_door=39 a_doorway=-142 a_dresser=3 a_few=15 a_fireplace=-148 a_fish=-135
    a_floor=-128 a_fork=-165 a_fridge=15 a_friendly=-8 a_gift=-94 a_glass=-195 a_good=78
    a_gray=-104 a_green=-32 a_grey=-58 a_half=-183 a_hall=-128 a_hallway=-98 a_hard=-142
    a_hat=-94 a_horse=-154 a_huge=-94 a_kitchen=-154 a_ladder=-56 a_lamp=-185 a_large=-183
    a_laundry=-104 a_left=-145 a_lion=-113 a_little=-92 a_lobby=-94 a_long=-122 a_lot=-94
    a_marble=-94 a_metal=-72 a_microwave=-94 a_mirror=11 a_narrow=-113 a_nice=-42 a_nursery=-94
    a_phone=-94 a_piano=-128 a_picture=-165 a_pillar=-94 a_pink=-94 a_plant=-112 a_pool=-104
    a_popcorn=-113 a_potted=-113 a_pretty=-94 a_purple=-42 a_quick=-8 a_railing=-113 a_red=-143
    a_refrigerator=-113 a_right=-153 a_road=-94 a_robot=43 a_rocking=-94 a_room=27 a_round=-179
    a_row=-142 a_rug=38 a_seat=-165 a_set=-121 a_sharp=-166 a_shelf=-121 a_shiny=-113 a_ship=-8
    a_short=-94 a_sign=30 a_sink=-35 a_slight=-200 a_small=-191 a_sofa=-78 a_square=-148
    a_staircase=83 a_stand=-94 a_stone=-56 a_stool=-94 a_stop=-89 a_straight=-94 a_striped=-128
    a_sweet=-113 a_table=-200 a_tall=-113 a_tan=-121 a_tapestry=-72 a_technician=200
    a_teeny=-113 a_television=-179 a_tiny=-128 a_toilet=-142 a_towel=-121 a_trash=-84
    a_turn=-128 a_tv=-94 a_u=-200 a_vase=-94 a_waiting=-94 a_wall=14 a_wardrobe=15 a_wee=15
    a_white=-121 a_whole=-94 a_wicker=-72 a_window=-200 a_wood=-113 a_wooden=-148 a_yellow=11
    abandon=30 abeam=-42 able=-42 abort=172 about=156 about_the=200 about_to=200 about_turn=-94
    above=200 absolute=86 absolutely=-42 abutment=-42 access=200 accident=172 accommodation=-42
    accomplished=-142 according=172 accordingly=200 accordingly_=200 accounting=-42 accounts=-42
    acquire=-72 across=-200 across_it=-165 across_the=-200 act=175 acting=200 action=200
    action_stop=190 actual=44 actually=119 add=130 addressee=172 adjacent=-42 adjustment=-42
    admin=172 administrator=200 administrator's=-142 administrator_has=200 admire=-42
    admiring=-42 adn=172 adorable=-42 adore=86 advance=-183 advance_to=-154 adventure=86
    advised=132 afford=-42 aft=-94 after=14 after_=90 after_each=200 after_every=200
    after_it=-198 after_that=-191 after_the=-200 after_this=119 again=-4 again_=94 again_and=59
    again_around=-94 again_at=-200 against=137 against_the=137 agent=172 ago=-42 agree=172
    agreed=172 ahead=-199 ahead_=-200 ahead_and=-165 ahead_of=-200 ahead_to=-113 ahhh=-42
    ahoy=86 aid=-142 aim=-42 airlock=-42 aisle=-200 aisle_=-165 aisle_and=-128
    aisle_between=-183 aisle_to=-94 alarm=-198 alcove=-154 alcove_on=-94 alighting=-42 align=-42
    all=128 all_=200 all_around=-142 all_of=124 all_robots=200 all_that=200 all_the=-73
    all_turns=200 all_you=100 alley=-42 allow=197 allow_what=197 allowed=119 almost=-42
    along=-149 along_it=-165 along_that=-94 along_the=-159 along_to=-113 along_until=-94
    alongs=86 alongside=-200 alongside_the=-200 alpha=-72 already=200 already_=200 alright=90
    alrighty=-42 also=-113 altar=-200 altar_=-113 alter=-42 alters=-42 always=181 always_do=200
    always_use=112 am=200 am_the=200 amazing=86 amble=-42 an=14 an_elevator=-113 an_hour=200
    an_office=-154 an_open=-2 an_orange=15 an_oval=-72 an_oven=-72 an_umbrella=-94
    ancelledcay=172 anchor=-72 and=-92 and_a=-100 and_after=-183 and_around=-113 and_as=-128
    and_at=-200 and_back=160 and_bear=-84 and_between=-94 and_carry=-191 and_climb=-169
    and_come=14 and_continue=-198 and_cross=-165 and_do=189 and_don't=-191 and_down=-72
    and_enter=-200 and_exit=-154 and_face=78 and_find=-191 and_finish=190 and_follow=-200
    and_get=-128 and_give=-94 and_go=-148 and_halt=-200 and_hang=-187 and_head=-200
    and_hold=-142 and_i=168 and_i'll=-8 and_in=15 and_into=-200 and_it=-10 and_it's=-157
    and_just=-128 and_keep=-200 and_leave=32 and_left=-183 and_look=-88 and_make=-200
    and_move=-94 and_no=-42 and_not=78 and_on=-154 and_once=-104 and_out=-132 and_pass=-200
    and_past=-89 and_proceed=-58 and_put=-94 and_report=200 and_right=175 and_round=43
    and_say=-113 and_second=-113 and_stand=62 and_stay=170 and_step=-179 and_stop=-200
    and_straight=-174 and_take=-121 and_that=-2 and_that's=-198 and_the=-102 and_then=-200
    and_there=-113 and_there's=-97 and_through=-200 and_to=-94 and_toward=-200 and_turn=-200
    and_two=-154 and_up=-200 and_veer=-113 and_wait=-96 and_walk=-200 and_when=-200
    and_white=-128 and_you=-74 and_you'll=-200 and_you're=-183 angel=-42 angle=-154
    annotator=172 announces=172 another=111 another_door=-94 answer=172 anticlockwise=-42
    any=192 any_door=200 any_further=200 any_more=183 any_of=197 anyhow=44 anyone=200
    anything=175 anytime=172 anyway=-42 anywhere=200 anywhere_=200 anywho=-42 apart=-42
    apartment=-72 aperture=-72 appearance=-42 appears=172 apples=-113 applies=172 apply=100
    apply_a=100 approach=137 approved=200 approximately=-72 aquarium=-165 arbitrary=-42
    arcade=-72 arch=-200 arch_=-200 arch_and=-198 arched=-94 arches=-42 archive=-72 archway=-200
    archway_=-200 archway_and=-165 archway_on=-94 archway_turn=-72 are=101 are_=200 are_a=200
    are_about=200 are_at=137 are_behind=-113 are_by=-169 are_done=2 are_facing=-200 are_four=-94
    are_given=197 are_in=-99 are_inside=-94 are_no=119 are_not=175 are_now=-200 are_on=-165
    are_out=160 are_some=-94 are_standing=-200 are_the=190 are_there=7 are_told=200 are_two=-200
    are_void=200 are_you=116 area=-200 area_=-165 area_and=-135 area_then=-72 area_with=-148
    aren't=44 arguments=172 arm=-42 arm's=-72 arm_=15 armchair=-172 armchair_=-134
    armchair_and=-94 armchair_then=-72 armchairs=-142 armchairs_and=-113 armor=-154 armor_=-142
    armour=-42 armrest=-72 arms=-183 arms_=-165 around=-133 around_=-89 around_and=-40
    around_go=-104 around_here=100 around_it=-85 around_its=-94 around_so=-183 around_the=-200
    around_then=-72 around_to=-200 around_until=-174 arr=-42 arrival=-42 arrived=144
    arrived_=200 arrow=-94 art=-128 artwork=-72 as=134 as_a=200 as_far=-200 as_if=141 as_it=90
    as_long=200 as_soon=-65 as_the=112 as_they=100 as_this=200 as_you=-111 as_your=200
    ascend=-113 ascended=-42 ascending=-42 aside=172 ask=137 asked=200 asks=200 asks_that=200
    asleep=44 assistant=200 assumed=172 at=-116 at_a=21 at_all=90 at_any=200 at_each=200
    at_every=200 at_it=-165 at_its=-200 at_my=116 at_once=200 at_that=-42 at_the=-200 at_your=67
    atm=-94 atrium=-72 attempt=172 attention=70 attic=-119 attic_=-18 attic_and=-104
    attic_through=-58 aunt=86 aunt's=86 auntie=-42 auntie's=-42 authorise=172 authorised=130
    authority=172 automatic=-174 automatic_doors=-154 available=-42 avoid=190 avoided=200 aw=-42
    await=130 away=25 away_=52 away_from=3 awful=-42 awning=-113 axis=114 axis_=121 axis_at=112
    axle=-42 aystay=172 azimuth=-42 b=-46 b_and=-94 babe=-42 babies=-72 baby=-1 baby's=-42
    baby_gate=-113 back=83 back's=-42 back_=200 back_and=141 back_door=-200 back_from=-19
    back_inside=-200 back_into=-142 back_is=100 back_of=-191 back_on=-174 back_out=-200
    back_past=-113 back_stairs=-94 back_through=100 back_to=132 backpack=-42 backs=-72
    backward=200 backward_wherever=112 backwards=160 bad=132 baddies=86 bag=-94 baggage=-72
    bakery=132 balcony=-200 balcony_=-200 balcony_and=-113 balcony_door=15 bales=-72 ball=-113
    balloon=-72 ballroom=-183 ballroom_=-94 balls=-113 balls_and=-94 balusters=-42
    balustrade=-72 bamboo=-72 bananas=-128 bananas_=-94 bandage=86 bang=-42 banister=7 bank=-8
    banquet=-72 baptismal=-72 baptistery=-113 bar=-200 bar_=-200 bar_and=-174 bar_area=-165
    bar_on=-113 bar_stool=-94 bar_stools=-200 bar_with=-113 barbecue=-165 barbecue_=-94
    barn=-174 barn_door=-113 barometer=-72 barracks=86 barrel=-183 barrel_table=-113
    barrels=-198 barrels_=-94 barrels_and=-154 barrier=-113 bars=-72 barstool=-42 base=119
    basement=43 basically=172 basket=-200 basket_=-154 basket_and=-113 basketball=-72
    baskets=-72 bath=-128 bathrobes=-42 bathroom=-135 bathroom_=-132 bathroom_and=-200
    bathroom_door=-113 bathroom_on=-159 bathroom_then=-142 bathroom_with=-113 bathtub=-143
    bathtub_=-200 bathtub_and=-72 battery=200 bay=-198 bay_window=-183 be=73 be_a=-174
    be_careful=-142 be_done=200 be_facing=-200 be_in=-189 be_next=-200 be_obeyed=200 be_on=-200
    be_the=-8 bead=-94 bead_curtain=-94 beaded=-94 beaded_curtain=-94 beam=-72 bean=-72
    beanbag=-67 beanbags=-72 bear=-94 bear_=-42 bear_left=-154 bear_right=-200 bear_slightly=-94
    bearing=-67 beautiful=-8 beauty=-72 because=-129 because_the=-128 bed=-200 bed_=-200
    bed_and=-200 bed_in=-94 bed_on=-198 bed_take=-84 bed_to=-113 bed_turn=-72 bed_walk=-94
    bed_with=-191 bedding=-42 bedroom=-64 bedroom_=34 bedroom_and=-200 bedroom_at=-128
    bedroom_go=100 bedroom_past=-94 bedroom_then=-58 bedroom_with=-187 bedrooms=172 beds=-116
    beds_=-198 beds_and=-142 beds_are=100 been=200 been_cancelled=200 beers=-42 before=84
    before_it=73 before_the=-47 before_we=15 before_you=132 began=200 began_=200 begin=85
    begin_=200 begin_by=-15 beginning=200 beginning_=190 begins=200 begins_=173 begun=172
    behalf=172 behave=172 behind=-200 behind_it=-191 behind_the=-200 behind_you=-200 beige=-94
    being=-94 believe=90 believes=86 bell=-165 bell_=-94 bellhop's=-72 bells=86 below=200
    below_is=200 belt=-94 bench=-200 bench_=-200 bench_and=-200 bench_in=-104 bench_then=-72
    benches=-142 benches_=-128 bend=-42 bends=-113 beneath=-165 beneath_the=-113 berth=-42
    beside=-92 beside_a=-94 beside_it=-142 beside_the=-200 best=86 bestie=-42 bet=-42 better=122
    between=-200 between_the=-200 between_them=-191 between_two=-26 beyond=43 beyond_it=100
    bicycle=-165 bicycle_=-113 bicycles=-72 bidet=-94 bidet_and=-94 bifurcates=-42 big=-200
    big_desk=-113 big_glass=-113 big_window=-94 bigger=44 biggest=-94 bike=-200 bike_=-121
    bike_and=-104 bikes=-142 bikes_and=-94 billet=-42 billiard=-113 billiard_table=-113
    billiards=-72 bin=-113 bin_=-113 bird=90 birdbath=-142 birdbath_=-113 birdcage=-72 birds=-42
    birthday=86 biscuit=44 bisect=-42 bit=-7 bit_left=-94 bit_of=152 bit_to=-94 black=-200
    black_and=-128 black_door=-113 black_railing=-84 blackboard=-142 blackboard_=-113
    blanket=-142 blanket_=-113 blankie=-42 blast=-42 bleachers=-72 bless=44 blew=86 blocked=59
    blocks=172 blood=-72 blotchy=86 blue=-178 blue_carpet=-128 blue_chairs=-94 blue_door=15
    blue_sofa=-84 blue_vase=15 blurs=172 board=21 board_=-200 board_with=-113 boardroom=-72
    boat=-72 body=-42 boiler=-191 boiler_=-154 bollard=-72 bones=-42 book=100 bookcase=-200
    bookcase_=-187 bookcase_and=-154 bookcase_then=-72 bookcases=-113 bookcases_=-113 books=-113
    bookshelf=-200 bookshelf_=-195 bookshelf_and=-84 bookshelves=-94 boom=-42 boot=-94
    booth=-200 booth_=-128 booth_and=-142 booths=-94 boots=-128 boots_and=-94 borders=172
    boring=86 boss=158 both=-182 both_flights=-142 both_sides=-142 bother=172 bottles=-94
    bottom=-200 bottom_=-200 bottom_and=-94 bottom_of=-200 bottom_turn=-154 bottom_you'll=-94
    bound=-94 bounds=152 bouquet=-72 bow=86 bowl=-51 bowl_=-26 bowl_of=-128 bowling=-42 box=-56
    box_=-113 boxes=59 boxes_=-94 boys=-42 branch=-72 brass=-154 bravo=44 breach=-42 bread=-113
    bread_and=-94 break=99 break_=200 break_room=-94 breakfast=-92 breakfast_nook=-119
    breaking=-42 breath=90 breathe=-42 breather=-42 breathtaking=-42 breeze=-42 brick=-143
    brick_steps=-94 brick_wall=-96 bricked=-42 bricks=-42 bridge=-56 bridge_and=-94 bright=-113
    bright_hallway=-94 bring=44 brings=-42 brochure=-113 broke=86 broken=200 brolly=-42
    bronze=-42 broom=-72 brother=170 brother's=90 brothers=-42 brown=-200 brown_couch=3
    brown_door=-113 brr=-42 brrr=-42 brushes=-42 bubbles=-42 bubbling=-42 bucket=-154
    bucket_=-94 buddha=-72 buddy=-94 buffer=172 buffet=-56 buffet_=-113 build=172 building=171
    building_=200 built=200 bulb=-72 bulkhead=-42 bullet=-8 bulletin=-113 bulletin_board=-113
    bum=-72 bump=-142 bump_into=-113 bunch=-113 bunch_of=-94 bunk=-200 bunk_=-113 bunk_beds=-200
    bunker=86 bunks=-72 bursting=-42 bushes=-72 bust=-198 bust_=-165 bust_on=-94 but=6
    but_do=100 but_don't=-154 but_i=90 but_it's=19 but_no=15 but_not=-154 but_only=-94
    but_that's=90 but_turn=-113 but_we're=15 but_you=38 but_you're=90 butler's=-42 butterfly=-42
    buttons=44 buy=86 by=-75 by_=59 by_a=49 by_facing=-179 by_it=-154 by_order=200 by_the=-137
    by_walking=-19 by_way=-195 bypass=-42 c=-183 cabin=-132 cabin_and=-113 cabin_door=-142
    cabinet=-200 cabinet_=-200 cabinet_and=-179 cabinet_with=-113 cabinets=-148 cabinets_=-113
    cabins=-113 cables=-94 cables_=-94 cactus=-183 cactus_=-113 caf=-142 cafe=-174 cafeteria=-42
    cage=-94 cake=-113 cake_=-113 cakes=-42 calibration=172 call=100 call_it=100 called=21
    called_a=-142 calling=172 calm=86 calories=-42 came=11 camera=132 camp=86 can=-35 can't=32
    can't_go=-2 can_=-142 can_and=-58 can_go=-142 can_see=-107 can_stop=-72 can_then=-128
    can_you=92 cancel=200 cancel_the=200 cancelled=200 cancelled_=193 cancelled_the=163
    candle=-200 candle_holder=-174 candles=-191 candles_=-113 candles_and=-113 candles_on=-94
    candy=-94 cannon=-42 cannons=-42 cannot=-42 canopy=-113 cans=-72 canteen=86 captain=194
    captain's=-42 car=-96 car_and=-128 card=-72 cardies=-42 care=86 careful=-200 carefully=-42
    caretaker=172 carousel=-72 carpet=-200 carpet's=-42 carpet_=-200 carpet_and=-104
    carpet_on=-72 carpet_to=-159 carpeted=-128 carpets=-42 carriage=-42 carried=200 carry=96
    carry_on=-24 carry_out=200 carrying=-72 cars=-72 cart=-142 carts=-154 carts_=-113 case=-85
    case_=-179 case_on=-113 case_walk=-58 cases=-42 cash=-200 cash_register=-191 casino=86
    cask=-72 castle=44 castles=86 cat=43 cat's=44 catalog=-42 catalogue=-42 catch=-42 cats=172
    cause=-128 cease=172 ceiling=46 ceiling_=18 cellar=-200 cellar_=-121 cellar_and=-94
    cello=-72 center=-112 center_aisle=-113 center_with=15 centre=-42 cereal=-113 chains=-72
    chair=-82 chair_=-168 chair_and=-183 chair_by=-154 chair_is=100 chair_on=-159 chair_walk=-84
    chair_with=-94 chairs=-106 chairs_=-200 chairs_and=-200 chairs_on=-142 chairs_turn=-58
    chalkboard=-42 chambers=-42 champ=86 chance=130 chandelier=-170 chandelier's=-42
    chandelier_=-200 chandelier_and=-135 change=183 change_of=190 changed=200 changed_your=197
    changes=-183 changes_from=-174 changing=-174 changing_room=-113 changing_table=-113
    chapel=-96 chapel_=-94 chapel_and=-8 chapels=86 characters=-42 charge=200 charger=200
    charging=7 charging_station=-165 charlie=-72 charming=-42 chart=-142 chart_table=-113
    chassis=-42 chat=172 chatting=-42 check=-78 check_in=-113 checked=130 checkerboard=-42
    checkout=-94 checkout_counter=-94 checkpoint=-42 cheerful=-42 cheers=78 cheery=-42 cheese=86
    chess=-113 chest=-154 chest_=-94 chest_of=-94 chick=-42 chief=200 chief_of=200 child=172
    children=-72 children's=-42 chill=-42 chimney=-94 china=-142 china_cabinet=-142 chinese=-142
    chips=-42 chocolate=-8 chocolate_fountain=-94 choices=-42 choo=44 choose=200 choose_the=160
    chop=86 chow=86 christmas=-26 christmas_tree=-26 chuck=-72 chum=-42 church=-22
    church_and=-94 chute=-72 cinderella=-42 cinema=86 circle=24 circle_and=200 circles=172
    circular=-42 circumference=-42 circumnavigate=-42 circumstances=200 clang=-42 clank=-42
    clarity=86 class=-94 classroom=-174 classroom_=-94 classroom_and=-113 clatter=86
    clattering=-42 claw=-42 clawed=-42 cleaner=-154 cleaner_=-94 clear=32 clear_the=-165
    clearance=130 cleared=86 clerestory=-42 clerk's=-72 clever=86 climb=-73 climb_=190
    climb_down=-94 climb_it=43 climb_the=-200 climb_to=-94 climb_up=-113 climbed=44 climbing=-26
    climbs=172 cloakroom=-42 clock=-192 clock_=-200 clock_and=-200 clock_go=-58 clock_on=-94
    clocks=-23 clockwise=-191 close=30 close_=-113 closed=75 closed_door=-113 closely=-42
    closes=-42 closest=-200 closest_to=-154 closet=-185 closet_=-200 closet_and=-30
    closet_on=-113 closet_then=-72 closet_with=-84 closing=-72 clothes=-137 clothing=-72
    clue=-42 cmd=172 coast=-142 coat=-200 coat_hooks=-200 coat_rack=-200 coat_room=-113
    coats=-67 coats_on=-94 coca=-142 cocoa=-42 code=100 coffee=-200 coffee_machine=-142
    coffee_maker=-113 coffee_table=-200 coffees=-42 cola=-154 cold=44 colonel=86 colonnade=-72
    colored=-94 colored_glass=-94 colorful=-42 coloured=-154 column=-198 column_=-94
    column_on=-72 columns=-165 comb=-42 combined=-42 come=-29 come_back=93 come_in=-113
    come_on=-94 come_out=-200 come_to=-158 comes=91 comfort=86 comfortably=86 comfy=30 coming=90
    command=200 commander's=86 commands=200 commands_as=200 commands_be=200 comment=172
    commode=44 companionway=-42 compass=-42 complaints=86 complete=200 completely=-72
    completing=172 completion=-42 compliance=172 computer=-200 computer_=-135 computer_and=-148
    computers=-128 concentrate=86 concern=100 concerned=86 concession=-42 concierge=-113
    concierge's=-72 concierge_desk=-94 concrete=-142 condition=190 conditional=-42
    conference=-200 conference_room=-200 conference_table=-113 confessional=-113 confirm=-42
    confuse=172 confuses=130 confusing=-42 consecutive=-42 conservatory=86 consider=200
    consider_the=190 consideration=-42 console=-128 console_table=-128 constant=-42
    constraint=-42 cont'd=-42 contact=-113 contact_=-94 contains=-42 content=172 continue=-21
    continue_down=-148 continue_on=-142 continue_past=59 continue_to=-200 continue_until=-2
    continuous=172 contrary=200 contrary_of=176 control=98 control_room=98 conveyor=-72 cooee=86
    cookies=86 cooking=172 cooler=-200 cooler_=-195 cooler_and=-128 coordinates=-42 copier=-200
    copier_=-128 copper=-72 copy=38 corkscrew=-42 corner=-112 corner_=-200 corner_and=-94
    corner_to=-113 correct=130 correction=200 corridor=-200 corridor_=-191 corridor_and=-121
    corridor_past=-142 corridor_to=-94 costumes=-113 cot=-72 cots=-94 cotton=86 couch=18
    couch_=14 couch_and=-60 couch_on=-94 couch_turn=-104 couches=-200 couches_and=-94 could=7
    could_you=20 couldn't=-42 council=172 count=78 count_the=-113 counted=-42 counter=-200
    counter_=-200 counter_and=-200 counter_clockwise=-94 counter_turn=-72 counting=-42
    country=-42 counts=200 couple=-198 couple_of=-198 course=-94 court=86 courtyard=-174
    courtyard_and=-94 cousin=86 cousin's=15 cover=-94 covered=-42 covers=86 cowboy=-72 cozy=-94
    cr=-142 crate=-72 crates=86 crayons=-42 cream=-94 creep=172 crest=-42 crib=-200 crib_=-183
    crib_and=-113 crib_go=-94 cribs=-42 cried=44 crikey=86 crisps=86 croissants=86 cross=-163
    cross_on=-142 cross_over=-191 cross_the=-200 cross_to=-94 crossed=-42 crosses=-42
    crossing=100 crossword=86 crying=44 crypt=-42 crystal=-94 crystals=-42 cubbies=15
    cubicle=-128 cubicles=-113 cuckoo=86 cue=-42 cues=-42 cup=-42 cupboard=-200 cupboard_=-113
    cupboards=-42 cuppa=-42 cups=44 curl=-42 curlers=-42 currency=-72 current=200 currently=-42
    curry=86 curtain=-200 curtain_=-200 curtain_and=-200 curtained=-72 curtains=-128 curtsy=-42
    curved=-174 curved_stairs=-154 curves=-94 curving=-42 curvy=-42 cushion=-198 cushion_=-183
    cushions=-72 custard=86 cut=160 cute=-94 cutest=-42 cutter=-72 cylinder=-42 cylinders=-72
    d=43 da=-72 dad=130 daddy's=44 daft=-42 damage=172 dance=-56 dance_floor=-128 dancer=172
    dancing=-42 danger=-142 dark=-42 darkroom=-42 darling=44 dartboard=-165 dartboard_=-154
    date=200 date_=200 datum=86 dave=86 davenport=15 dawdle=-94 day=200 day_=184 daylight=-42
    days=86 dead=-26 dead_ahead=-94 dear=-72 decided=172 decimetre=-42 decision=172 deck=-84
    deck_=-24 deck_with=-94 decking=-42 declare=172 decode=172 deep=19 deer=-113 deer_head=-113
    defined=-42 definition=-42 degree=-94 degrees=-200 degrees_=-183 degrees_and=-128
    degrees_left=-113 degrees_right=-154 degrees_so=-94 degrees_to=-191 delete=200 delivers=-42
    delta=-72 demo=-142 demonstration=86 den=-183 den_=-121 den_and=-72 denied=172 dentist's=-42
    dentists=86 depart=-42 department=15 department_=15 descend=-46 descend_the=-198
    descending=-72 descends=-42 describe=172 described=200 described_=200 description=200
    design=-42 desk=-200 desk_=-200 desk_and=-200 desk_on=-142 desk_the=-174 desk_to=-104
    desk_turn=-94 desk_walk=-104 desk_with=-200 desks=-128 desks_=-8 desks_and=-128
    destination=127 detailed=-42 details=86 detect=-42 detective=-42 determine=-42 developer=200
    developer's=-142 deviate=-42 deviation=-42 dexter=-42 di=-42 diagonally=-154
    diagonally_to=-94 diametrically=-42 dictionary=-72 did=200 did_last=200 different=152
    ding=-72 dingy=-42 dining=-200 dining_room=-200 dining_table=-200 dinosaur=-67
    dinosaur_skeleton=-94 direction=67 direction_of=-2 direction_you=197 directional=172
    directions=200 directions_=200 directions_are=200 directions_that=163 directly=-154
    directly_beneath=-94 director=172 dirty=44 disabled=172 discard=86 disco=-72 dishwasher=-200
    dishwasher_=-142 dishwasher_and=-104 displacement=-42 display=-200 display_case=-174
    disregard=200 disregard_all=176 disregard_the=154 distance=58 distance_to=-165 distances=172
    diving=-72 dizzy=-42 dj=-72 do=161 do_=200 do_any=200 do_is=-27 do_it=200 do_me=-94
    do_not=160 do_nothing=127 do_only=200 do_that=-94 do_the=200 do_what=200 do_you=59 dock=200
    doctor=172 doctor's=29 document=200 does=151 does_not=200 doesn't=-72 dog=-119 dog's=-42
    dog_bed=-94 dogleg=-42 doing=200 dokey=-42 doll=-42 dolls=-94 don't=-6 don't_climb=-113
    don't_enter=-142 don't_go=-57 don't_have=-8 don't_need=-94 don't_stop=-2 don't_take=-11
    don't_turn=-165 don't_worry=15 done=134 done_=200 done_once=-84 done_when=-198 dong=-42
    donkey=86 donotfollowtheroute=172 dont=172 dooor=172 door=-120 door's=-42 door_=-152
    door_a=-94 door_and=-168 door_at=-154 door_b=-94 door_behind=-174 door_but=15 door_by=-94
    door_go=24 door_in=-200 door_into=-142 door_is=57 door_left=-94 door_near=-113
    door_next=-165 door_not=-154 door_of=-165 door_on=-200 door_opposite=-165 door_says=90
    door_stop=-113 door_that=41 door_that's=-183 door_the=-200 door_then=-200 door_there=-165
    door_to=-170 door_turn=36 door_with=-200 door_without=-94 door_you=20 doormat=-174
    doormat_=-165 doors=-178 doors_=-169 doors_and=-200 doors_are=-94 doors_at=-94 doors_go=-148
    doors_on=-148 doors_one=-94 doors_that=100 doors_then=-179 doors_with=-94 doorway=-157
    doorway_=-51 doorway_and=-179 doorway_of=-200 doorway_on=-169 doorway_then=-58
    doorway_to=-154 doorway_walk=-19 doorway_with=-128 doorways=-42 double=-36 double_doors=-200
    doubling=-42 doubt=172 down=-93 down_=31 down_a=-128 down_and=200 down_five=-154
    down_it=-183 down_on=100 down_one=-200 down_the=-200 down_them=-183 down_three=-174
    down_to=-54 down_two=-165 down_until=-94 downstairs=-113 downwards=-42 dr=30 drafting=-94
    drafting_table=-94 drain=-72 draw=132 drawbridge=-72 drawers=-154 drawers_=-113 drawing=-72
    drawings=86 drawn=-42 dreadful=-42 dream=86 dreamy=-42 drenched=-42 dresser=-200
    dresser_=-105 dresser_and=-84 dresser_on=-58 dresser_then=-169 dresses=-72 dressing=-198
    dressing_room=-191 dried=-72 drifting=-42 drill=100 drink=-42 drinking=-142
    drinking_fountain=-142 drinks=-72 drip=-42 drive=173 driver=86 drives=-42 drop=200
    drop_this=132 dropped=86 drown=-42 drum=-191 drum_kit=-165 drums=-142 drums_=-94 dryer=-200
    dryer_=-183 dryers=-72 duck=15 ducts=-42 ductwork=-42 dumbbells=-72 dumpling=-42
    dumpster=-72 dumpsters=-72 dungeon=-42 during=172 duties=172 duty=-42 e=-191 each=200
    each_direction=200 each_doorway=176 each_minute=176 each_other=-142 each_step=173
    each_time=200 each_turn=200 earlier=200 early=86 earrings=86 ears=15 ears_=15 ease=86
    easel=-165 easel_=-94 easel_and=-128 easiest=-42 east=132 easy=4 eat=-72 eaten=86 eating=-42
    ebg=172 echo=86 echoey=86 edge=-200 edge_=-113 edge_of=-200 edges=-72 effect=190 eggs=-72
    egress=-42 egyptian=-42 eight=100 eighth=-72 either=-154 element=-42 elephant=-72
    elevation=-42 elevator=-200 elevator_=-174 elevator_and=-191 elevator_doors=-113
    elevator_lobby=-113 elevators=-191 elevators_=-154 eleven=-72 else=175 emergency=59 emit=200
    empty=-42 end=-38 end_=-181 end_and=-40 end_at=-165 end_go=-113 end_of=-110 end_so=100
    end_the=200 end_this=197 end_turn=-142 end_up=52 end_you'll=-94 endlessly=172 ends=-56
    ends_=-174 ends_at=-174 energy=172 engine=-113 engine_room=-113 engineer=172 engineers=172
    engines=172 enjoy=-42 enjoying=-42 enough=160 enter=-50 enter_=-183 enter_a=190 enter_and=43
    enter_the=-135 enter_through=-183 entering=-165 entering_any=-94 entertainment=-72
    entrance=-137 entrance_=15 entrance_and=-94 entrance_to=-113 entry=-142 entryway=-195
    entryway_=-113 entryway_and=-72 environment=-42 episode=200 episodes=172 equipment=-72
    erase=172 erehay=172 errand=172 error=200 error_=200 escalator=-200 escalator_=-183
    escalator_up=-94 escalators=-42 espresso=-72 essential=200 essential_that=200
    establishing=86 ethay=172 ethics=172 evacuation=-142 even=78 event=-72 ever=200 every=200
    every_door=78 every_few=149 every_instruction=200 every_landmark=200 every_order=176
    every_time=110 every_turn=200 everybody=100 everyone=149 everything=153 everywhere=122
    everywhere_=152 eway=172 ex=-42 exactly=190 exam=-94 exceed=172 except=173 exception=172
    exchange=100 exchanged=200 exclude=-42 excluded=-42 excuse=132 execute=78 executed=172
    executing=200 execution=-42 exercise=-105 exercise_bike=-154 exit=-200 exit's=-42 exit_=-191
    exit_and=30 exit_sign=-200 exit_the=-200 exit_through=-165 exits=-42 expanded=-42
    explain=132 exploring=194 exposed=-42 extinguisher=-200 extinguisher_and=-165 extract=-42
    ey=-42 eye=-113 eyepiece=-42 eyes=-94 f=-42 fab=86 face=-55 face_=-94 face_away=-113
    face_the=-61 facing=-200 facing_a=-200 facing_it=-94 facing_the=-200 fact=86 factory=86
    failed=86 failure=172 fake=-42 fall=-165 falling=-42 falls=86 family=-159 family_room=-148
    fan=-26 fancy=44 far=-188 far_=-96 far_as=-200 far_corner=-165 far_door=-128 far_end=-200
    far_left=-142 far_side=-154 far_wall=-198 farther=-94 farthest=-94 faster=-42 faucet=86
    fault=172 favor=-42 favour=-42 feel=114 feeling=86 feet=-74 feet_=-94 feet_from=-165
    feet_to=-135 fell=132 fella=86 fella's=-42 fellow=-42 fence=-128 fence_=-128 fern=-174
    fern_=-165 fetched=-42 fetches=172 few=55 few_feet=-135 few_steps=36 fgbc=172 ficus=-72
    fiddling=-42 field=-42 fifteen=-42 fifth=-128 fig=-72 figures=86 file=-72 filing=-154
    filing_cabinet=-128 fill=-42 filled=-42 fills=-42 film=-72 final=-8 finally=44 find=-200
    find_a=-200 find_it=-183 find_me=-113 find_the=-200 find_yourself=-94 fine=81 finish=149
    finished=156 finished_=160 fire=-36 fire_extinguisher=-200 fire_hose=-113 fireplace=-200
    fireplace_=-200 fireplace_and=-200 fireplace_then=-84 fireplace_to=-84 fires=-42
    firewood=-72 first=-21 first_=173 first_and=-154 first_bar=-94 first_door=-131 first_is=-94
    first_landing=-200 first_left=-113 first_of=7 first_opening=-142 first_right=-154
    first_room=52 first_row=-94 first_seat=-113 first_step=58 first_table=-113 first_two=-191
    first_window=-113 first_you=-113 firstly=-42 fish=-200 fish_tank=-200 fit=86 fits=86
    fitting=-113 fitting_room=-94 five=-34 five_steps=-179 fixed=172 fixtures=-42 flag=-94
    flagpole=86 flags=-142 flank=-42 flap=-94 flat=38 flew=86 flies=86 flight=-166 flight_=-94
    flight_of=-200 flights=-200 flights_of=-191 flip=200 flipped=172 float=-72 floor=-38
    floor_=-113 floor_and=7 floor_changes=-165 floor_go=-94 floor_in=100 floor_is=190
    floor_lamp=-142 floorboard=-72 floors=-154 floors_=-94 flop=-72 flower=-174 flower_shop=-94
    flower_stand=-113 flowers=-183 flowers_=-113 flowers_on=-94 flue=86 fluffy=-94 fold=-72
    folding=-94 follow=-45 follow_=149 follow_it=-200 follow_so=112 follow_the=-118 followed=130
    following=162 following_steps=200 following_the=43 follows=200 follows_=200 font=-174
    font_=-113 font_and=-94 food=-72 foosball=-142 foosball_table=-142 foot=-200 foot_of=-200
    footstool=-42 for=119 for_a=-11 for_all=200 for_it=100 for_me=-21 for_right=200 for_the=75
    for_this=115 for_today=200 for_you=127 for_your=137 forbid=172 forbidden=172 forbids=200
    forbids_you=200 forget=200 forget_all=200 forget_the=62 forgetting=-42 forgot=-113
    forgotten=172 fork=-174 forks=-42 form=-72 forth=-42 forward=-123 forward_=-125
    forward_and=-142 forward_between=-113 forward_down=-94 forward_past=-183 forward_to=-142
    forward_two=-94 forwards=-42 found=200 found_it=200 fountain=-200 fountain_=-200
    fountain_and=-94 four=-135 four_step=-58 four_steps=-165 four_windows=-113 fourteen=-72
    fourth=-40 fourth_door=7 foyer=-120 foyer_=-70 foyer_and=-94 foyer_with=-84 frame=-113
    framed=-113 free=-8 freedom=-42 freely=172 freeze=130 freezer=-191 freezer_=-174 french=-200
    french_doors=-200 freshen=-42 fresher=-42 fridge=-194 fridge_=-200 fridge_and=-108
    fridge_then=-104 friend=69 friend's=86 friend_=93 friend_and=-94 friendly=-8 from=55
    from_here=18 from_it=105 from_now=200 from_the=-17 from_there=-198 from_where=100
    from_you=121 from_your=190 front=-148 front_=59 front_desk=-174 front_door=-83 front_of=-180
    front_pew=-94 frosted=-72 froze=86 frozen=130 fruit=-8 fruit_bowl=15 ft=-142 full=23
    full_access=176 full_of=-32 fully=-42 fun=59 function=-42 functional=-42 funnily=-42
    funny=86 furnace=-72 furniture=190 further=198 further_=103 fuse=61 fuse_box=15 fuss=-42
    future=172 fyi=86 gabbing=86 gallery=-88 gallery_=-94 gallery_and=-113 galley=-94 game=-88
    game_room=-165 gangway=-72 gap=-200 gap_between=-94 garage=-72 garage_=-8 garage_by=-72
    garage_go=-84 garden=0 garden_=30 gardening=-42 gas=-113 gate=-200 gate_=-200 gate_and=-94
    gate_in=-113 gave=200 gawp=-42 gazebo=-72 gears=172 geese=-42 general=200 generator=-113
    generator_=-113 generous=172 gentle=-72 gentlemen=86 gently=-72 get=-153 get_a=15
    get_in=-113 get_off=-94 get_out=-200 get_there=-2 get_to=-200 get_you=-26 gets=-42
    getting=-42 giant=-142 gift=-183 gift_shop=-183 give=-2 give_it=-94 given=200 given_=200
    gives=197 giving=-42 glamorous=-42 glance=86 glass=-173 glass_=30 glass_and=-94
    glass_case=-94 glass_door=-200 glass_doors=-200 glass_table=-200 glass_walls=-113
    glass_window=-113 glasses=-128 glasses_=-94 glazed=-72 glazing=-42 globe=-200 globe_=-183
    globe_and=-128 globes=-42 glove=86 glowing=-72 glug=-42 go=-109 go_=91 go_across=-94
    go_ahead=-142 go_all=-200 go_along=-200 go_and=-165 go_any=43 go_anywhere=200 go_around=-200
    go_back=177 go_backward=200 go_behind=-113 go_between=-200 go_by=-200 go_down=-200
    go_forward=-45 go_from=-174 go_halfway=-94 go_home=200 go_in=-99 go_inside=-113 go_into=-117
    go_left=-89 go_on=31 go_out=-200 go_outside=-200 go_over=-94 go_past=-200 go_right=-75
    go_round=-62 go_slightly=-128 go_straight=-200 go_the=160 go_there=43 go_through=-186
    go_to=-117 go_toward=-200 go_towards=-191 go_under=-191 go_up=-179 goal=200 goal_=200
    goal_is=103 goals=172 goat=163 goes=72 goes_to=-113 going=-68 going_down=-67 going_in=-56
    going_left=-94 going_past=-128 going_straight=-179 going_through=-128 going_to=22
    going_until=-200 going_up=-165 gold=-200 golden=-94 gone=-18 gone_past=-94 good=191
    good_=200 good_morning=163 goodbye=172 goodies=-42 gorgeous=-113 gosh=86 gossip=86 got=10
    got_a=71 got_the=90 got_to=-94 gowns=-42 grab=-42 gradient=-42 gramophone=-72
    gramophone's=-42 gran's=-42 grand=44 grandad's=-42 grandfather=-200 grandfather_clock=-200
    grandma's=86 grandmother=86 grandpa's=86 granny=132 granny's=86 grass=-142 grate=-42
    grating=-42 graveyard=-72 gray=-200 great=78 green=-179 green_=-142 green_armchair=15
    green_chair=-113 green_chairs=-113 green_door=-42 greenhouse=44 greeted=-72 grew=86
    grey=-200 grey_couch=-84 grid=86 grill=-200 grill_=-200 ground=-8 ground_floor=-8 grown=-113
    guard=200 guard's=-165 guard's_chair=-165 guardrail=-42 guardroom=86 guess=69 guess_what=90
    guest=20 guest_room=-198 guests=172 guidance=172 guitar=-113 gumball=-113
    gumball_machine=-113 gun=-142 gunner's=86 gym=-80 gym_=44 gym_and=-121 gym_with=-94
    gymnasium=-94 ha=15 had=155 had_a=200 haha=44 hair=-128 half=30 half_landing=-94 half_of=200
    half_right=-94 halfway=-200 hall=-190 hall's=-42 hall_=-200 hall_and=-123 hall_by=-128
    hall_door=15 hall_into=-142 hall_of=-113 hall_then=-159 hall_through=-94 hall_turn=-84
    hall_with=-165 hallway=-178 hallway_=-173 hallway_and=-200 hallway_as=-94 hallway_in=-94
    hallway_on=-191 hallway_past=-200 hallway_splits=-174 hallway_then=-128 hallway_to=-174
    hallway_turn=-121 hallway_with=-200 hallways=-94 hallyway=-142 halt=46 halt_=67 halt_at=-16
    halt_by=-94 hammock=-128 hammock's=-42 hamper=-142 hamper_and=-94 hamster=-72 hand=50
    hand's=172 hand_=78 hand_door=-142 hand_for=200 hand_side=-198 handedness=172 handles=-72
    handrail=-142 hands=185 handy=86 hang=-162 hang_a=-200 hangar=86 hanging=-200
    hanging_on=-142 hangs=-88 hansen=172 happens=172 happy=-142 hard=-200 hard_left=-165
    hard_right=-94 hard_to=-113 hardwood=-72 harp=-112 harp_=-94 harp_and=-128 harpsichord=-113
    harpsichord_=-113 has=186 has_a=-103 has_been=200 has_cancelled=163 has_changed=200
    has_closed=200 has_no=122 has_to=200 has_withdrawn=132 hat=-191 hat_=-94 hat_stand=-113
    hatch=-112 hatch_=-174 hats=-42 have=150 have_a=58 have_arrived=113 have_been=200
    have_found=190 have_gone=18 have_reached=103 have_the=200 have_to=66 have_you=170 having=69
    hay=-142 he=86 he's=121 head=-17 head_down=-128 head_for=-154 head_of=190 head_office=200
    head_on=-94 head_out=-154 head_straight=-94 head_through=-94 head_to=-200 head_towards=-187
    heading=-200 heading_you=-94 headmaster's=86 headquarters=194 headroom=-42 heads=-42
    health=172 hear=200 heard=200 heart=-42 hearth=-72 heated=-42 heater=-128 heater_=-94
    heave=-42 heavy=-165 hedge=-113 heed=172 height=-72 helical=-42 hello=168 hello_=90 help=15
    helps=-72 hence=15 henhouse=86 her=110 here=143 here's=-8 here_=119 here_and=200 here_is=99
    hereby=200 herein=172 hero=86 hex=172 hey=153 hi=139 hi_=90 hi_to=15 hidden=-72 hide=86
    hiding=-42 high=-137 high_chair=-56 high_chairs=-94 higher=43 highest=-72 hill=-42 him=-119
    him_=-191 hint=-42 his=-42 hit=59 hit_the=-113 hiya=86 hm=-42 hold=3 hold_=59 hold_at=-198
    hold_by=-113 hold_on=-200 hold_position=78 holder=-174 holder_=-84 holder_and=-104
    holding=-42 holds=-42 hole=-72 holes=86 home=200 home_=200 hon=-42 honestly=132 honey=86
    hook=-128 hooks=-200 hooks_=-200 hooks_and=-113 hoop=-72 hooray=-42 hoover=-94 hop=78
    hope=44 hopeless=86 horizontal=100 horse=-200 horse's=-42 horse_=-183 horses=-42 hose=-142
    hose_=-128 hospital=3 hospital_bed=-183 hot=-164 hot_tub=-200 hotel=-20 hour=200 hours=172
    house=86 house_=91 house_and=152 houses=-42 hover=-42 how=35 how's=187 how's_the=187
    how_to=-94 huge=4 human=172 hun=-42 hundred=86 hung=44 hungry=44 hunt=90 hurry=-191
    husband=-42 hut=-72 i=116 i'd=194 i'd_like=152 i'll=124 i'll_be=90 i'm=85 i've=52
    i've_got=-42 i_am=200 i_can=163 i_can't=156 i_don't=-8 i_e=-183 i_got=92 i_had=61 i_have=200
    i_know=45 i_left=-142 i_mean=-198 i_need=85 i_said=81 i_say=67 i_tell=200 i_want=-80
    i_was=198 ice=-200 ice_cream=-94 ice_machine=-200 idea=-72 identical=-42 idle=-42 if=80
    if_i=152 if_it=43 if_they=200 if_you=38 if_you're=-94 ignore=126 ignore_the=88 ignored=-42
    ignorethenextstep=172 ignoring=130 ii=-72 iii=-72 ikea=-142 image=172 imagine=140
    immaterial=-42 immediate=200 immediately=14 immediately_=100 immediately_and=100
    important=172 in=-17 in_=-62 in_a=-51 in_all=200 in_an=-142 in_and=-200 in_at=-165
    in_between=-200 in_by=-94 in_charge=200 in_closet=-154 in_front=-178 in_go=160 in_here=15
    in_it=-40 in_my=90 in_order=15 in_our=163 in_place=200 in_reverse=200 in_that=59 in_the=-70
    in_there=-92 in_this=200 in_through=-191 in_turn=7 in_you=100 in_your=200 inch=172
    inclination=-42 increased=172 indefinitely=172 indications=172 indoor=-72 indoors=-42
    infiltrate=-42 information=-113 ingress=-42 initial=100 injured=172 inn=86 inner=-94
    innocent=-42 input=86 inside=-200 inside_=-200 inside_and=-179 inside_it=-94 inside_the=-200
    inside_then=-72 inside_through=-159 insists=-42 inspector=172 inspectors=172 instance=-42
    instead=121 instead_=200 instead_of=57 instruction=200 instruction_=200 instructions=165
    instrument=-42 intent=86 interchanged=172 intermediate=-42 internal=-42 interpret=200
    intersection=-72 intersects=-42 intervening=-42 interviews=86 into=-158 into_a=-50
    into_it=-94 into_the=-200 invert=172 inverted=200 inviting=-42 iron=-198 iron_door=-142
    iron_gate=-94 ironing=-174 ironing_board=-174 is=102 is_=77 is_a=15 is_an=43 is_and=-94
    is_at=-2 is_behind=-88 is_called=59 is_cancelled=90 is_closed=105 is_essential=200 is_in=7
    is_just=-94 is_left=-8 is_named=200 is_next=-174 is_no=200 is_not=200 is_nothing=80
    is_off=190 is_on=-64 is_only=90 is_open=30 is_out=190 is_right=160 is_the=-39 is_to=179
    is_void=200 is_what=152 is_where=-153 is_written=200 is_wrong=200 is_your=58 is_yours=-94
    island=-200 island_=-135 island_and=-135 island_on=-121 isn't=133 issue=200 issued=200 it=32
    it'll=59 it's=-1 it's_a=29 it's_for=15 it's_got=-42 it's_just=-8 it's_left=-8 it's_like=19
    it's_not=-8 it's_the=-137 it_=10 it_a=-113 it_and=-133 it_by=-94 it_curves=-94 it_down=-94
    it_ends=30 it_go=-113 it_goes=-8 it_has=62 it_in=100 it_into=-94 it_is=76 it_looks=-78
    it_on=-200 it_right=78 it_says=200 it_stop=-94 it_tells=112 it_the=173 it_then=-94
    it_there's=-113 it_through=-142 it_to=-70 it_turn=-128 it_until=-113 it_was=200 it_with=59
    it_you=-94 item=-42 itinerary=172 its=-41 its_end=-200 its_far=-165 its_left=-183
    its_near=-94 its_right=-200 its_tail=-94 itself=-94 iv=-128 jackets=-142 jackets_=-113
    jacuzzi=-159 jacuzzi_and=-94 jacuzzis=-23 jeez=86 jelly=86 jigsaws=-42 job=122 job_=200
    job_is=78 jog=-42 join=86 joke=172 journey=100 journey_ends=100 judge's=-42 jug=-72
    juice=-94 jukebox=-154 jukebox_=-113 juliet=86 jump=-42 jumper=86 junction=78 just=-29
    just_a=-88 just_after=-94 just_before=-200 just_go=-67 just_inside=-200 just_like=90
    just_outside=-179 just_past=-94 just_stop=-128 just_to=-94 just_turn=-94 just_walk=-113
    k=-72 karaoke=86 karate=86 keep=-32 keep_going=-138 keep_on=-191 keep_out=100 keep_right=-94
    keep_the=-200 keep_to=-200 keep_turning=200 keep_walking=-46 keeper=86 keeping=-200
    keeping_it=-183 keeping_the=-142 keeping_them=-94 keeping_to=-128 keeps=15 kept=15
    kettle=-42 kevin=-42 key=-42 keyboard=-26 keypad=-72 keys=-154 kick=-42 kiddies=-42
    kidding=130 kids=-42 kill=-142 killing=-72 kiln=-42 kilo=86 kind=65 kind_of=-94 kindly=200
    kindness=-42 king=-72 king's=-42 kiosk=-72 kit=-200 kit_=-174 kitchen=-80 kitchen_=-114
    kitchen_and=-12 kitchen_door=78 kitchen_doorway=-94 kitchen_island=-200 kitchen_now=-142
    kitchen_past=-94 kitchen_sink=-113 kitchen_through=-135 kitchen_with=-94 kitchen_you=-191
    kitchenette=-26 knee=44 knees=-42 knife=-72 knight=-42 knitted=86 knob=-72 knock=15
    knocker=-72 know=105 know_=90 know_it's=15 know_that=81 know_what=121 knows=194 l=-119
    l_=-165 la=-42 lab=-72 label=200 labelled=-142 lad=-42 ladder=-200 ladder_=-191
    ladder_and=-200 ladder_on=-113 ladder_to=-94 ladies=-42 lady=-94 lady's=-42 lake=86
    lamp=-200 lamp_=-200 lamp_and=-200 lamp_on=-165 lamps=-198 landing=-200 landing_=-192
    landing_and=-183 landing_turn=-154 landings=-42 landlord=172 landmark=200 landmark_is=190
    landmarks=-42 landscape=-72 lane=-42 lantern=-72 lap=-113 large=-200 largest=-42 laser=86
    last=67 last_=200 last_door=-104 last_every=112 last_one=-46 last_step=103 last_stool=-113
    last_thing=-191 last_year=163 lasts=200 lasts_=163 late=132 later=194 lateral=130 lathe=-72
    latin=-42 laugh=194 laughing=86 laundry=-200 laundry_basket=-174 laundry_room=-200 lava=-72
    law=172 lawful=172 lawn=-72 lawyers=172 layman=-42 lead=49 leading=-113 leads=-128 leaf=-42
    leaning=-72 learn=44 least=172 leather=-200 leather_chair=-84 leather_couch=-94 leave=-2
    leave_=103 leave_by=-198 leave_it=100 leave_the=-69 leave_this=115 leave_through=-183
    leaves=-72 leaving=-200 leaving_the=-200 left=-138 left_=-149 left_90=-142 left_across=-94
    left_after=-200 left_again=-195 left_along=-113 left_and=-161 left_around=-198 left_as=-56
    left_at=-200 left_before=-128 left_by=-56 left_corner=-142 left_down=-142 left_enter=-135
    left_for=91 left_go=-200 left_halfway=-94 left_hall=-94 left_hand=3 left_in=-198
    left_into=-123 left_is=136 left_just=-94 left_left=15 left_my=-154 left_not=-113 left_of=-88
    left_one=-183 left_out=43 left_pass=-94 left_past=-195 left_side=-200 left_so=-56
    left_staircase=-94 left_the=-154 left_then=-200 left_there=-200 left_through=-198
    left_to=-50 left_towards=-113 left_turn=72 left_until=-154 left_up=-94 left_walk=-113
    left_wall=-128 left_when=78 left_where=-128 left_which=15 left_with=43 leftmost=-113
    lefts=-42 leftward=-42 leg=-112 legend=-42 lego=-142 legs=61 legs_=90 leisurely=-42
    lemon=-72 length=-183 length_of=-113 lent=-42 less=-42 let=118 let's=2 let's_get=-128
    let's_go=121 let's_start=-94 letter=150 letters=-142 level=-128 librarian=-42 library=-105
    library_=-113 library_and=-113 lie=-72 lied=172 lies=172 lieu=-42 life=67 life_jackets=-142
    lifeboat=-113 lifeboat_=-94 lifeboats=-113 lifebuoy=-113 lifebuoy_=-113 lifeguard=-94
    lifeguard's=-42 lift=-4 lift_=-27 lifts=-42 light=-183 lighted=-42 lighthouse=-72 lights=-94
    like=49 like_a=90 like_the=-78 like_you're=-174 limb=-42 limit=-42 limits=130 line=-113
    line_on=-154 lined=-42 linen=-200 linen_closet=-191 linen_cupboard=-94 lines=-154 lintel=-42
    lion=-142 lions=15 list=200 listen=15 lit=-94 literally=-72 little=-130 little_=-165
    little_and=-142 little_bit=-94 little_hallway=-94 little_table=-94 lives=86 living=-46
    living_room=-61 lizard=86 load=-42 loading=-72 lobby=-200 lobby's=-42 lobby_=-200
    lobby_and=-200 lobby_to=-94 lobby_with=-94 lobster=86 locate=-198 locate_a=-142
    locate_the=-94 location=130 locked=132 locker=-94 locker_room=-94 lockers=-200 lockers_=-191
    lockers_and=-154 locomotion=172 loft=-105 loft_=-154 login=-142 lol=172 long=-53 long_as=200
    long_hallway=-113 long_part=-94 long_table=-84 long_wooden=-94 longer=200 loo=15 loo's=-42
    look=-73 look_at=47 look_down=-94 look_for=-146 look_to=-94 looking=62 looking_at=-191
    looking_for=160 looks=18 looks_like=67 loom=-72 loop=172 loose=-42 lose=-42 lost=94 lot=-78
    lot_of=-128 lots=-154 lots_of=-154 loud=44 loudspeakers=-42 lounge=-200 lounge_=-128
    lounge_and=-128 lounge_chairs=-128 lounge_go=-58 lounger=-72 loungers=-128 loungers_=-94
    love=93 lovely=-174 low=149 lower=-113 lowest=-42 luck=44 lucky=-42 luggage=-113 lunch=-113
    lying=194 m=-200 m_=-165 m_and=-94 machine=-200 machine's=-42 machine_=-200 machine_and=-200
    machine_on=-142 machine_then=-104 machine_with=-94 machines=-195 machines_=-128 made=46
    made_it=152 made_of=-154 made_out=-94 magazine=-72 magazines=-113 magazines_=-94
    magnificent=-42 magnitude=-42 mail=86 mailbox=-154 mailbox_=-113 mailboxes=-183 main=-142
    maintain=-42 majesty=-42 make=-165 make_a=-200 make_for=-165 make_your=-200 maker=59
    makers=172 makes=-56 makeup=-94 making=-8 man=91 management=200 manager=200 manager's=-113
    mannequin=-142 mannequin_=-94 mannequins=-72 manoeuvre=172 mantelpiece=-42 manufacturer=200
    many=-8 map=141 map's=-42 map_=-154 maps=86 marble=-200 marble_bust=-113 marble_stairs=-113
    marble_statue=-113 march=-72 margin=172 mark=-94 marked=-165 market=-42 married=-42
    marshal=200 marta=172 masks=-72 massage=-119 massage_room=-113 massage_table=-154
    massages=-42 massive=-42 master=-154 master_bedroom=-154 mat=-182 mat_=-200 match=86 mate=15
    mats=-72 matter=200 may=200 maybe=-42 maze=86 me=100 me_=87 me_a=-67 me_to=200 mean=-5
    mean_the=-8 meaning=-72 means=141 meant=86 measure=172 measured=86 measuring=-42 meet=130
    meeting=-165 meetings=-42 memo=86 memory=200 mended=86 mention=172 mentioned=200
    mentioned_=200 mere=-42 mess=-128 message=200 message_from=200 metal=-200 metal_stairs=-165
    meteor=-42 meteorite=-94 meter=-113 meters=-200 meters_=-94 meters_and=-142 metre=-42
    metres=175 mezzanine=-72 microfilm=-72 microwave=-200 microwave_=-187 microwave_and=-84
    microwaves=-23 middle=-143 middle_=-113 middle_aisle=-113 middle_and=-94 middle_between=-113
    middle_of=-55 middle_one=-113 midpoint=-42 might=-67 milk=-94 miller's=-142 million=44
    mind=116 mind_=122 mind_the=18 mine=15 mine's=44 minerals=-72 mini=-72 minimise=-42
    minimum=-42 ministry=172 mint=-42 minus=-72 minute=200 minute_=200 minutes=194 mirror=-111
    mirror_=-200 mirror_and=-187 mirror_on=-113 mirror_then=-94 mirror_with=-94 mirrored=155
    mirrored_=200 mirrored_wall=-113 mirrors=-200 mirrors_=-94 mirrors_on=-165 misc=-142
    misreading=-42 miss=170 misses=-42 missing=-42 mission=58 mistake=160 mister=44
    mistletoe=-72 mix=200 mode=200 model=86 moment=190 money=-72 monitors=-72 mood=-42 mop=-154
    mops=86 more=65 more_=197 more_step=-113 more_steps=-142 more_than=190 morning=121
    mosey=-113 most=-42 mother=65 mother's=-42 motion=200 motionless=172 motors=172 mount=-42
    mountains=-72 mounted=-72 mouse=86 moustache=132 move=106 move_=200 move_away=-195
    move_forward=-165 move_toward=-179 moved=132 movement=200 moves=152 movie=-42 moving=143
    moving_=149 moving_walkway=-154 much=200 mud=-179 mud_room=-179 mudroom=-72 mum=152
    mum's=-42 mummies=-72 mummy=-56 mummy's=-42 mummy_and=-113 murder=86 museum=-42
    museum_in=-94 music=-142 music_room=-142 must=200 must_be=15 must_go=200 must_not=200 my=122
    my_brother=152 my_brother's=90 my_cousin's=15 my_friend=81 my_mother=65 my_old=200 myself=86
    n=172 nag=-42 nah=172 nail=-72 name=100 named=200 named_=200 nan's=86 narrator=172
    narrow=-200 narrow_hallway=-113 narrow_passage=-94 naturally=-42 nave=-94 navigation=200
    nb=86 nd=137 near=-55 near_it=-113 near_the=-131 nearer=-42 nearest=-67 nearest_mirror=-94
    nearest_the=-165 nearest_toilet=-183 nearly=15 necessary=172 need=91 need_a=70 need_is=-19
    need_not=200 need_to=16 needed=-42 needn't=-42 needs=187 negate=172 negative=100
    neighbor=-42 neighbor's=86 neighborhood=-42 neighbour=172 neither=44 nemo=-42 neon=-94
    nephew=-42 net=132 never=200 never_mind=114 new=193 newel=-72 news=200 newspaper=-72
    newspapers=-113 newspapers_=-94 newsstand=-72 next=-69 next_=181 next_door=-200
    next_left=-84 next_one=58 next_room=-165 next_to=-200 nice=-59 nicer=172 niche=-72 night=90
    nightmare=86 nightstand=-191 nightstand_=-113 nil=86 nine=-26 ninety=-183
    ninety_degrees=-113 nip=-72 no=133 no_=200 no_further=-154 no_longer=200 no_more=-142
    no_need=200 nobody=195 nomenclature=86 nominal=-42 none=200 none_of=200 nonsense=172
    nook=-143 nook_=-159 nook_and=-113 nook_with=-84 nor=86 normal=-113 north=-113
    northbound=-42 nose=-94 not=134 not_a=78 not_allow=197 not_do=200 not_enter=200 not_go=62
    not_going=15 not_move=200 not_pass=43 not_right=-94 not_stop=33 not_take=122 not_that=30
    not_the=-154 not_to=67 not_turn=103 not_up=-94 not_use=141 not_walk=200 not_where=90
    note=200 notes=86 nothing=127 nothing_=200 nothing_in=43 notice=188 notice_a=44
    notice_board=-94 notice_the=200 notice_your=149 noticeboard=-42 noting=-42 november=-42
    novice=86 now=39 now_=200 now_and=160 now_go=-142 now_in=-200 now_on=200 now_so=-142
    now_there=100 now_turn=-165 now_walk=-142 now_you=-200 now_you're=-174 nowhere=-42
    nulling=-42 number=49 number_three=-113 numbers=-42 nurse=190 nurse's=-174 nursery=-200
    nursery_=-159 nursery_and=-179 nursery_then=-72 nurses=-128 nurses_station=-94 o=-142
    o'clock=-198 o'clock_and=-94 obey=200 obeyed=200 obeyed_=200 object=200 objective=-94
    oblique=-72 observation=44 obsolete=86 obstacle=-72 obstacles=-42 obvious=-42 obviously=-72
    occupies=-42 occurs=-42 ocean=-42 octagonal=-72 of=-29 of_3=-94 of_90=-94 of_a=-134
    of_all=129 of_an=-94 of_apples=-94 of_armor=-154 of_black=-94 of_chairs=-73 of_doors=-11
    of_drawers=-94 of_each=200 of_every=200 of_feet=-165 of_flags=-113 of_green=-113 of_it=-82
    of_management=163 of_one=-94 of_seats=-142 of_stairs=-200 of_steps=-154 of_tables=-94
    of_that=58 of_the=-73 of_them=-89 of_these=200 of_this=200 of_those=-113 of_three=-94
    of_what=200 of_which=-94 of_white=-113 of_windows=-113 of_you=-83 of_your=192 off=89
    off_=200 off_from=-94 off_the=-11 off_to=-113 offer=-42 office=-50 office_=-105
    office_and=-200 office_does=112 office_has=194 office_with=-121 officer=200 official=200
    offline=172 offset=-42 oh=200 oi=86 ok=200 ok_=200 okay=-48 okay_=122 okay_so=-42 okey=-42
    old=113 old_man=-94 older=-42 ollie=-42 on=-93 on_=-15 on_a=-38 on_and=-33 on_both=-128
    on_by=-94 on_down=-94 on_going=-128 on_it=-106 on_its=-200 on_left=-142 on_my=15 on_out=-94
    on_past=-174 on_right=-165 on_straight=-94 on_the=-114 on_this=30 on_through=-113 on_to=-200
    on_top=-94 on_treat=194 on_until=59 on_up=-94 on_wheels=-113 on_your=-190 once=68 once_=200
    once_and=65 once_every=149 once_so=112 once_the=-94 once_there=-94 once_you=-48
    once_you're=-94 once_you've=-94 one=-47 one's=-8 one_=-60 one_after=-94 one_and=-62
    one_at=92 one_by=90 one_deck=-94 one_door=-94 one_flight=-200 one_floor=-22 one_in=-142
    one_is=81 one_more=-113 one_of=-128 one_on=-200 one_side=59 one_step=-200 one_that=-78
    one_too=100 one_two=-94 one_up=-94 one_who=190 one_with=-200 one_you=-200 ones=58 ones_=78
    only=111 only_=200 only_and=18 only_one=-198 only_the=144 onto=-200 onto_the=-200 ooh=-72
    oops=-154 open=-142 open_=-154 open_door=-200 open_doorway=-183 open_it=-26 open_the=-174
    opening=-200 opening_=-94 opening_and=-94 opening_in=-128 opening_on=-128 opens=-200
    opens_on=-94 opera=-42 operational=172 operator=200 operator's=172 operator_has=112
    operators=172 opposite=133 opposite_=103 opposite_of=200 opposite_the=-198 optical=-42
    optional=172 options=-42 or=-2 or_down=43 or_what=-94 orange=-134 orchids=-42 order=200
    order_=200 order_of=200 ordered=172 orders=200 orders_=200 orders_so=132 orders_you=132
    organ=-128 organ_pipes=-94 orientation=-42 origin=-42 other=75 other_=141 other_end=18
    other_hand=200 other_one=-154 other_side=-74 other_way=164 others=130 otherwise=172
    ottoman=-195 ottoman_=-154 ought=200 our=165 ours=-72 out=-62 out_=90 out_and=-198
    out_at=-94 out_by=-183 out_from=-94 out_in=-113 out_into=18 out_of=-120 out_on=-128
    out_onto=-200 out_past=-94 out_the=11 out_through=-200 out_to=-200 out_turn=-154 outdoor=-72
    outer=-42 outeray=172 outline=172 output=194 outrank=172 outside=-110 outside_=-29
    outside_and=-135 outside_it=-113 outside_of=-128 outside_on=-142 outside_room=-94
    outside_the=-200 outside_then=-84 outside_through=-113 outvoted=86 oval=-159 oven=-139
    oven_=-200 oven_and=-18 oven_on=-94 over=-47 over_by=15 over_the=-149 over_to=-85
    override=154 overview=86 overwrite=172 owes=86 own=200 own_axis=200 owner=200 owner's=-113
    owner_of=200 paces=-42 page=172 paint=-94 painted=52 painting=-200 painting_=-159
    painting_and=-84 painting_of=-128 paintings=-183 paintings_=-165 pair=-154 pair_of=-128
    pairs=-42 pajamas=-42 pal=15 pale=-42 pallet=-72 pallets=-42 palm=-154 palms=86 pane=-42
    panel=-198 panic=86 pantry=-168 pantry's=86 pantry_=-148 pantry_and=-72 pantry_door=-26
    pantry_with=-84 pants=86 papa=86 paper=-113 papers=-42 par=-113 paragraph=172 parallel=-72
    parish=-42 park=-142 parked=15 parking=-72 parlor=44 parlour=-42 part=127 part_of=141
    party=-42 pass=-153 pass_2=-104 pass_a=-200 pass_between=-113 pass_four=-94 pass_it=30
    pass_one=-113 pass_something=163 pass_the=-180 pass_three=-183 pass_through=-113
    pass_to=-142 pass_two=-195 pass_under=-94 passage=-198 passage_and=-113 passed=43 passes=-94
    passing=-154 past=-200 past_=100 past_a=-200 past_all=-191 past_both=-128 past_every=-191
    past_four=-128 past_it=-81 past_six=-94 past_the=-200 past_them=-165 past_three=-113
    past_two=-200 pat=-42 patch=-42 path=-25 path_=-94 path_that=78 patience=172 patio=-200
    patio_=-121 patio_and=-200 patio_turn=-72 patrol=44 pause=43 pay=29 pea=-42 peanuts=-72
    pears=-42 peasy=-42 pebbles=-42 pedestal=-72 peek=-72 peel=-72 pegs=-113 penguin=-26
    penguin_=15 people=5 people_put=15 people_sitting=-174 percent=172 perfect=-42 perform=190
    pergola=-42 perimeter=172 permission=172 permit=130 permitted=172 perpendicular=-42
    persian=-72 person=200 person_in=200 person_who=156 personnel=172 pet=86 petal=-42 pete=86
    peter=172 pew=-191 pew_=-113 pews=-198 pews_=-94 pews_on=-94 phase=-165 phone=-96 phone_=-26
    phone_booth=-128 photo=-72 photographs=-72 photos=-142 photos_on=-113 piano=-200 piano_=-200
    piano_and=-148 piano_then=-72 pianos=-121 pick=103 picture=-101 picture_=-148
    picture_of=-183 pictures=-113 piece=-42 pillar=-200 pillar_=-174 pillar_and=-113
    pillar_turn=-84 pillars=-169 pillars_and=-128 pillows=-72 pinball=-113 pinball_machine=-113
    pinch=-42 ping=-174 ping_pong=-174 pink=-191 pins=-42 pipes=-154 pit=-113 pitch=-42
    pivot=100 place=200 place_=181 place_is=200 place_where=200 places=86 plan=200 plan_=200
    plane=-72 planetarium=-42 planets=-72 planned=172 plant=-200 plant_=-200 plant_and=-200
    plant_in=-113 plant_on=29 plant_take=-58 plant_turn=-135 planters=-72 plaque=-165
    plaster=-42 plastic=-94 plate=130 plates=-113 play=-72 player=-128 player_=-94 playhouse=-42
    playing=-42 playroom=-154 please=155 please_=14 please_do=200 please_don't=190
    please_return=200 please_walk=44 plinth=-42 plonk=-72 plotter=-72 pls=172 plunge=-174
    plunge_pool=-174 plus=-42 po's=-142 pocket=-42 podium=-113 point=65 point_=30 pointing=86
    points=-8 pointy=-42 poke=-42 pole=-42 police=200 policy=172 polish=-72 pommel=-72 pond=15
    pong=-174 pong_table=-174 pool=-200 pool_=-165 pool_and=-200 pool_table=-200 pool_with=-94
    poor=44 pop=-113 popcorn=-174 poppet=-42 porch=-195 porch_=-125 porch_and=-159 porches=172
    port=-72 portable=-42 porthole=-113 porthole_=-94 portholes=-72 portrait=-191 portrait_=-113
    portraits=-72 portside=-42 pose=100 posh=86 position=105 post=-67 post_=-94 postcard=86
    postcards=-72 postcondition=-42 poster=8 pot=-154 pot_=-94 pots=43 pots_hanging=-94
    potted=-200 potted_palm=-128 potted_plant=-200 potted_tree=-128 pottery=-94 potting=-72
    pouffe=-42 poultry=-42 pouring=86 powder=-42 power=142 prams=-42 prayer=-72
    preconditions=-42 prep=-42 present=200 presents=-42 press=-72 pressure=-72 pretend=170
    prettiest=86 pretty=-174 previous=200 principal's=-72 principle=172 print=100 printed=200
    printer=-174 printer_=-94 printer_and=-113 printers=-72 prior=-42 priority=44 privacy=172
    private=-113 privileges=172 prize=-42 probably=86 proceed=-120 proceed_past=-179
    proceed_to=-2 projection=-42 projects=-42 pronto=-42 proof=-72 proud=-72 psst=172 pub=-42
    pucker=-42 pull=-42 pulled=-42 pulpit=-154 pulpit_=-94 pump=-72 pup's=-42 pupils=86
    puppet=-113 puppet_theater=-94 purple=-164 purposes=172 pursuant=172 push=-198 put=140
    put_=200 puts=-72 putting=-72 pyjamas=-42 q=-42 qty=-42 quarter=-72 quarters=86 query=-42
    questions=152 queue=152 quick=-67 quickly=-113 quiet=-154 quietly=-72 quilt=-72 quilts=-42
    quite=-42 r=-191 rack=-200 rack_=-200 rack_and=-200 rack_of=-142 rack_on=-113 rack_with=-113
    racks=-62 racks_=-94 racks_of=15 radiator=-165 radiator_=-142 radiators=-113 radio=132
    rail=-191 railing=-200 railing_=-183 railing_and=-142 railing_on=-183 railing_to=-154
    railings=-94 rails=-94 railway=86 rain=15 rally=86 ramp=-200 ramp_=-200 ramp_and=-125
    ramp_on=-94 range=-72 rather=200 rather_than=190 ray=-72 rd=-42 reach=-102 reach_it=-113
    reach_the=-124 reached=189 reached_the=156 reaching=-113 reaching_it=-113 read=200
    read_is=200 read_the=156 read_this=200 readable=86 reader=100 reading=30 reads=113 ready=61
    real=47 really=-142 rear=59 rear_door=-94 rearward=-42 rearwards=-42 reason=200 reasons=172
    recall=172 receive=172 received=86 reception=-200 reception_=-121 reception_desk=-200
    recessed=-42 recipe=-42 reciprocal=-42 recliner=-72 recliners=-72 recon=86 record=-113
    record_player=-113 recovered=86 recruit=86 red=-185 red_carpet=-183 red_curtain=-154
    red_door=-67 red_fridge=-94 red_line=-94 red_sofa=-26 reference=-42 reflection=172
    reflective=-94 refrain=200 refrigerator=-200 refrigerator_=-200 refrigerator_and=-84
    refrigerator_turn=-58 refuse=172 refused=172 regardless=172 register=-200 register_=-154
    regulation=172 reinstate=172 reject=172 relaid=-42 relax=130 relaying=86 released=172
    relief=86 relieved=-72 relocation=86 remain=193 remainder=200 remaining=43 remains=130
    remark=86 remember=200 remember_to=200 remind=-42 reminds=86 remove=172 repeat=78
    repeated=130 replace=200 replaced=200 replacement=172 report=200 reported=86 request=200
    requested=172 requesting=-42 requests=172 require=-42 required=15 requirement=-42
    requires=200 rescinded=172 research=172 respect=172 rest=200 rest_=175 rest_of=200
    restaurant=-113 restaurant_and=-94 restroom=-72 restrooms=-72 result=-72 results=86
    retrace=107 retrace_your=36 return=200 return_to=200 reverse=156 reverse_of=200 reversed=172
    revert=172 revoked=172 revolution=-42 revolving=-183 revolving_door=-183 rewarded=-42
    ride=-128 riding=-42 right=-123 right's=-42 right_=-122 right_a=-94 right_after=-200
    right_again=-198 right_along=-113 right_and=-200 right_angle=-94 right_around=-148
    right_as=-51 right_at=-159 right_before=-40 right_beside=118 right_by=-191 right_corner=-165
    right_down=-94 right_go=-200 right_hand=-153 right_immediately=-113 right_in=20
    right_instead=43 right_into=-200 right_is=18 right_just=-200 right_now=-128 right_of=-139
    right_off=-94 right_on=-128 right_one=-183 right_past=-187 right_right=-165 right_side=-200
    right_so=-11 right_stop=-72 right_take=-94 right_then=-200 right_there=-70 right_to=14
    right_towards=-165 right_turn=-27 right_until=-165 right_up=-128 right_wait=-154
    right_walk=-200 right_wall=-142 right_when=-142 right_with=-113 right_you=15 righto=-42
    rightwards=-42 righty=-42 rim=-42 ring=38 rink=-42 riser=-42 risers=-42 rises=-42
    riverside=-198 road=-8 robes=-72 robot=80 robot_=-10 robotics=172 robots=200 robots_must=200
    rock=-42 rocking=-200 rocking_chair=-198 rocking_horse=-94 rocks=-113 roger=86 role=172
    roll=78 rolled=-128 rolled_up=-94 roller=-72 rolling=-42 rolls=-42 roman=-72 romeo=86
    roof=-22 roof_=-94 room=-107 room's=-72 room_=-109 room_after=-30 room_and=-200
    room_before=141 room_between=-94 room_by=-128 room_door=-128 room_for=78 room_go=-128
    room_has=52 room_is=30 room_on=-200 room_opposite=-165 room_past=-94 room_straight=-128
    room_that=119 room_the=-165 room_then=-200 room_through=-135 room_to=-112 room_turn=-195
    room_using=-187 room_where=-154 room_which=-94 room_with=-180 room_you=-198 rooms=99
    rooms_=140 root=172 rope=-137 rope_barrier=-113 rotate=60 rotate_twice=176 rotating=172
    rotation=59 roughly=-72 round=-19 round_=200 round_and=29 round_dining=-94 round_it=-113
    round_table=-142 round_tables=-113 round_the=-200 round_to=-113 round_window=15 rounded=-42
    rounding=-42 route=200 route_=200 route_and=200 route_is=200 routes=172 row=-200 row_=-142
    row_and=-113 row_of=-200 rowing=-113 rows=-191 rows_of=-165 rubber=-72 rubbish=44 rug=-200
    rug_=-200 rug_and=-200 rug_ends=-94 rug_in=-78 rug_to=-84 rule=200 rules=200 rumbling=86
    run=200 run_lasts=200 runner=-142 runner_rug=-113 running=-72 runs=-113 rush=-42 s=-42
    sacristy=86 saddle=-128 saddle_=-94 safe=-94 safest=172 safety=200 safety_officer=163
    said=200 said_=100 sailor=44 salad=-113 salon=-113 saloon=-72 same=-35 sandbox=-94
    sandwich=86 sanitary=-42 saturn=-72 sauna=-200 sauna_=-121 sauna_and=-121 sauna_go=-84
    sausage=-42 saw=152 say=125 say_hi=-8 say_it=200 say_that=200 saying=70 says=200 says_=200
    says_left=200 says_stop=-191 says_that=200 scale=-200 scale_=-183 scales=-72 scary=44
    scavenger=86 school=19 science=15 sconces=-42 scoot=-94 scrap=200 scratch=172 screen=-200
    screen_=-200 screen_door=-154 screens=-165 scroll=-142 scullery=-113 sculpture=-169
    sculpture_=-84 sculpture_and=-72 sculptures=-23 sea=86 sealed=172 search=152 seashells=-72
    seat=-200 seat_=-113 seat_on=-94 seating=-72 seats=-191 seats_=-113 sec=-42 second=-113
    second_=-81 second_door=-44 second_floor=-113 second_left=-113 second_one=-200
    second_right=-148 second_set=-113 second_turn=100 secondly=-42 seconds=172 secret=132
    secs=86 section=194 sectional=-94 sector=-42 secure=-94 security=134 see=-128 see_a=-107
    see_an=-159 see_if=-8 see_stairs=-94 see_that=-165 see_the=-200 see_two=-113 see_you=90
    seek=86 seen=15 sees=86 segment=-72 select=-94 self=86 sell=86 sells=-42 send=200
    sendorfer=-142 sense=130 sensor=-42 sent=200 sentence=200 sentences=200 sentry=86
    separating=-42 separation=-42 serious=86 seriously=172 served=172 server=194 serves=-42
    service=156 service_=190 serving=-42 session=172 set=-27 set_of=-200 sets=-128 sets_of=-128
    seven=-26 seventh=-72 sewing=-154 sewing_machine=-154 shade=-94 shade_=-94 shall=196
    shaped=-113 shaped_like=-94 sharp=-101 sharp_left=-200 sharp_right=-150 sharply=-72 she=200
    she's=90 shed=-8 sheets=-42 shelf=-200 shelf_=-183 shelf_and=-187 shelf_of=-113
    shelf_with=-113 shells=-42 shelves=-200 shelves_=-128 shelving=-42 shhh=-72 shift=-94
    shiny=-183 shiny_black=-94 shiny_floor=-113 ship=4 ship's=-42 ship_=15 shipping=172
    shoe=-200 shoe_display=-113 shoe_rack=-128 shoe_store=-94 shoes=-78 shoes_=-128 shop=-185
    shop_=-142 shop_and=-8 shop_past=-94 shop_turn=-94 shopping=-113 shopping_carts=-113
    short=-119 short_of=-94 shorter=86 should=81 should_be=-51 should_go=200 should_not=200
    should_now=-142 should_see=-200 should_stop=-142 shoulder=172 shout=-42 shouted=200
    shouts=172 shove=-42 show=100 shower=-200 shower_=-113 shower_and=-121 shower_room=-165
    shower_turn=-72 showers=-154 shredder=-42 shush=86 shut=200 shut_down=200 shutdown=172
    shutters=-72 shy=-42 side=-136 side_=-152 side_and=-200 side_as=-94 side_chapel=-94
    side_door=-165 side_of=-182 side_to=-113 sideboard=-94 sides=64 sight=86 sign=-83 sign_=-62
    sign_and=-174 sign_with=-113 signal=172 signed=172 signs=-56 sill=-94 sill_=-94 silly=44
    silver=-94 simple=-72 simplified=86 since=-56 since_the=-128 sing=86 singing=-42 single=119
    single_step=160 sink=-194 sink_=-200 sink_and=-154 sink_in=49 sinks=-198 sinks_=-113
    sinks_and=-154 sir=172 sister=90 sit=36 sit_down=100 sit_on=-8 site=176 sitrep=86 sits=-142
    sitting=-125 sitting_area=-113 six=-42 six_=-8 sixth=-113 sixty=-42 size=-72 skeleton=-165
    skeleton_=-94 ski=-72 skinny=-113 skip=112 skip_the=67 skipped=172 skirt=-113 skirting=172
    skis=-72 skylight=-78 skylight_=-56 sleep=200 sleeping=44 sleeps=-42 slept=163 slide=114
    slider=-142 slides=-42 sliding=-200 sliding_door=-198 sliding_doors=-200 sliding_glass=-94
    slight=-200 slight_left=-200 slight_right=-200 slightly=-200 slightly_left=-200
    slightly_right=-200 slip=-94 slope=-42 sloping=-42 slot=-72 slow=44 slowly=-165 small=-167
    small_door=-165 small_hallway=-94 small_office=-94 small_room=-94 small_table=-187
    smalls=-42 smell=-42 smells=90 smelly=-42 smidge=-72 smile=-94 smooth=-42 snack=-113
    snail=-72 snake=86 sneak=-72 snuggled=-42 so=54 so_be=-94 so_do=177 so_find=-113 so_get=-94
    so_go=-200 so_i=163 so_it's=19 so_just=-191 so_keep=81 so_let's=-94 so_please=200
    so_rotate=112 so_stop=-2 so_take=100 so_that=-162 so_that's=-94 so_the=-165 so_turn=7
    so_use=112 so_walk=-32 so_you=-36 so_you're=-165 soak=-42 soccer=-42 socks=15 sofa=-90
    sofa_=-200 sofa_and=-200 sofa_is=81 sofa_on=-84 sofas=-26 sofas_=15 soffit=-42 soft=-26
    software=172 soldier=-72 some=-12 some_stairs=15 somebody=104 someone=189 someone's=-42
    someone_else=200 something=200 something_=200 sometimes=-42 somewhere=-113 song=-42 soon=-10
    soon_as=-65 sooner=-42 soonest=86 sooo=132 sore=86 sorry=14 sort=-42 sound=44 sounds=86
    soup=86 soup's=86 source=-42 spa=-37 spa_=-18 space=65 space_between=-94 span=-42
    speaker=122 speaker_=15 speakers=-42 speaking=200 special=172 species=-42 specifically=-42
    speed=130 spiders=-72 spin=168 spin_around=119 spin_on=200 spinning=-94 spiral=-200
    spiral_staircase=-191 split=86 splits=-198 spoken=172 sports=-42 spot=67 spot_=38 spot_a=-94
    spring=86 squad=-72 square=-7 square_table=-84 squares=-42 squeaks=-42 squeeze=-128
    squirts=-42 squishy=-42 st=-72 stable=-72 stack=-128 stack_of=-128 stacked=-142 staff=7
    staff_only=-165 stage=-189 stage_=-142 stage_and=-113 stage_up=-94 stain=-72 stained=-113
    stained_glass=-113 stair=-174 stair_=-94 staircase=-137 staircase_=-200 staircase_and=-165
    staircase_on=-94 staircases=15 stairs=-95 stairs_=-64 stairs_all=-113 stairs_and=-130
    stairs_are=-113 stairs_beside=-94 stairs_but=-113 stairs_down=18 stairs_go=-128
    stairs_going=-8 stairs_next=-165 stairs_not=-128 stairs_on=-128 stairs_take=-142
    stairs_that=30 stairs_then=-174 stairs_to=-200 stairs_turn=-200 stairs_up=-113
    stairs_which=-94 stairs_with=-183 stairway=-200 stairway_=-174 stairway_and=-135
    stairway_on=-84 stairwell=-165 stall=-72 stalls=-72 stand=-10 stand_=48 stand_and=-73
    stand_by=46 stand_in=43 stand_next=-159 stand_still=156 stand_then=-58 stand_turn=-94
    stand_with=-200 standard=-42 standing=-99 standing_in=-200 standing_on=-113 stands=-72
    star=-113 star_=-94 starboard=-113 staring=-42 stars=-72 start=83 start_=200 start_at=-128
    start_by=-200 start_in=-174 start_there=-94 started=200 starting=-23 starting_at=-179
    state=-42 station=-200 station_=-94 station_and=-165 stationary=-42 statue=-200 statue_=-200
    statue_and=-148 statue_of=-191 status=172 stay=187 stay_=200 stay_here=200 stay_in=105
    stay_on=-154 stay_put=200 stay_there=105 stay_where=200 stayed=86 staying=-94 stays=-42
    steady=-42 steam=-142 steam_room=-113 steel=-183 steeply=-42 steer=86 steering=130 step=-18
    step_=40 step_and=53 step_away=-165 step_inside=-94 step_into=-200 step_of=160 step_out=-83
    step_over=-200 step_stop=-84 step_turn=-128 stepping=-113 steps=-57 steps_=-3 steps_and=-179
    steps_down=-200 steps_forward=-142 steps_go=-113 steps_going=-94 steps_into=-113
    steps_on=-159 steps_then=-195 steps_to=-200 steward=-42 stick=-42 sticks=-94 still=173
    still_=200 stinky=-42 stone=-200 stone_bench=-94 stone_floor=-94 stone_stairs=-94
    stone_steps=-165 stones=-72 stool=-200 stool_=-200 stool_and=-128 stool_then=-72
    stool_with=-94 stools=-200 stools_=-183 stools_and=-128 stools_to=-72 stools_turn=-84
    stoolss=-23 stop=-150 stop_=-102 stop_1=-174 stop_a=-174 stop_and=-16 stop_as=78
    stop_at=-200 stop_before=-119 stop_behind=-200 stop_beside=-200 stop_between=-200
    stop_by=-200 stop_facing=-179 stop_here=84 stop_in=-200 stop_inside=-198 stop_is=190
    stop_just=-200 stop_near=-46 stop_next=-200 stop_now=200 stop_on=-200 stop_once=-165
    stop_outside=-200 stop_right=-200 stop_there=-200 stop_to=-165 stop_under=-200
    stop_when=-143 stop_where=41 stop_with=-154 stopped=100 stopping=41 stopping_=190 stops=-72
    store=-174 store_=-128 storey=-42 story=172 stove=-174 stove_=-125 stove_and=-187
    stove_in=-94 stove_past=-94 straight=-200 straight_=-81 straight_across=-200
    straight_ahead=-200 straight_and=-154 straight_between=-195 straight_down=-200
    straight_into=-165 straight_on=-19 straight_out=-200 straight_past=-200 straight_then=-84
    straight_through=-134 straight_to=-200 straight_until=-200 straight_with=-94 stranger=86
    streamers=-72 street=-142 stretcher=-42 stretching=-42 string=130 stringed=-42 strings=-72
    strip=-42 striped=-200 striped_blanket=-94 striped_rug=-113 strips=-42 stripy=-94 stroll=-42
    stroll_through=15 strollers=-42 stuck=200 student=15 studio=-8 studio_=-94 study=-200
    study_=-165 study_and=-191 stuff=194 stuffed=-113 stuffed_bear=-113 subheading=-94 subj=86
    subject=44 submarine=86 success=200 such=-94 sugar=-42 suit=-154 suit_of=-154 suitcase=-42
    suitcases=-42 summer=-42 sump=-42 sun=-195 sun_room=-159 sunburn=86 sundays=86 sundial=-72
    sunflowers=-72 sunken=-26 sunken_living=15 sunny=-42 sunroom=-183 sunroom_=-94 sunshine=-42
    super=-72 supersedes=172 superstar=-42 supervisor=200 supplies=86 support=172 sure=81
    surface=-72 sushi=-42 suspended=172 swan=-42 swap=200 swap_left=200 swapped=-142 sway=-42
    swear=132 sweep=-42 sweet=-128 sweet_little=-94 sweetheart=-42 sweetie=-42 swimming=15
    swimming_pool=15 swing=-200 swing's=-42 swing_=-165 swing_and=-113 swinging=-165
    swinging_doors=-128 swings=-42 swingy=-42 switch=90 switched=172 switches=-142 swivel=-94
    swore=86 sworn=-42 system=200 t=-154 t_=-94 t_junction=-94 ta=-42 tabel=-142 table=-197
    table_=-200 table_and=-200 table_around=-72 table_at=-94 table_between=-94 table_go=-94
    table_head=-58 table_in=-159 table_is=43 table_keeping=-128 table_on=-200 table_so=-135
    table_that=-113 table_then=-200 table_to=7 table_turn=-121 table_walk=-113 table_where=-128
    table_with=-200 tables=-62 tables_=-142 tables_with=-94 tada=-42 tail=-94 take=-44
    take_a=-103 take_about=-94 take_it=-183 take_one=-128 take_the=-76 take_two=43 take_you=-154
    taken=200 takes=-42 taking=15 talk=132 tall=-185 tall_chair=-94 taller=-42 tallest=-72
    tan=-195 tan_chair=-58 tank=-200 tank_=-200 tank_and=-169 tank_then=-84 tape=-154 taped=-42
    tapestry=-200 tapestry_=-135 tapestry_and=-84 tapestrys=-23 target=78 task=196 task_=200
    tasking=-42 tastes=-42 taxi=86 tea=-128 teacher=172 teacher's=-142 teacher's_desk=-142
    teal=-72 team=200 technician=200 technician_with=200 teddies=-72 teddy=86 teenager's=-42
    teeny=-128 teh=172 telephone=-113 telescope=-174 telescope_=-154 television=-200
    television_=-200 television_and=-84 television_then=-58 televisions=-23 tell=200
    tell_you=200 teller=-26 teller_windows=15 telling=194 tells=200 tells_you=200 telly=-72
    tempting=-42 ten=163 tenner=86 tennis=86 tent=-72 term=-42 terminal=-42 terminate=-72
    terminates=-72 terminating=-42 terms=172 terrace=-119 terrace_=-56 terrace_and=-94
    terrible=86 test=172 text=200 text_says=200 text_you=149 than=136 than_the=78 thank=200
    thank_you=200 thanks=160 that=96 that's=-156 that's_a=-56 that's_all=-94 that's_at=-94
    that's_closest=-94 that's_got=-128 that's_it=-154 that's_on=-94 that's_shaped=-94
    that's_the=-191 that's_where=-119 that's_your=-142 that_=181 that_and=-113 that_are=175
    that_door=-198 that_follow=163 that_follows=200 that_go=-113 that_goes=116 that_has=-200
    that_is=97 that_it=49 that_looks=52 that_none=200 that_one=-55 that_robots=200 that_room=160
    that_says=-198 that_the=106 that_was=200 that_way=91 that_you=200 the=-50 the_3=-72
    the_administrator=200 the_aisle=-200 the_alarm=-165 the_alcove=-113 the_altar=-198
    the_aquarium=-154 the_arch=-200 the_archway=-200 the_armchair=-174 the_art=-94 the_atm=-94
    the_attic=-119 the_automatic=-142 the_baby=-10 the_back=-162 the_balcony=-183
    the_ballroom=-183 the_bananas=-94 the_banister=43 the_bank=15 the_baptistery=-113
    the_bar=-200 the_barbecue=-142 the_barn=-142 the_barrels=-113 the_base=-94 the_basement=59
    the_bath=-94 the_bathroom=-126 the_bathtub=-150 the_bay=-174 the_bead=-94 the_beaded=-94
    the_bed=-176 the_bedroom=-46 the_beds=-128 the_beginning=200 the_bell=-142 the_bench=-200
    the_bicycle=-142 the_bidet=-94 the_big=-200 the_biggest=-94 the_bike=-113 the_bikes=-113
    the_billiard=-113 the_bird=90 the_birdbath=-113 the_black=-187 the_blackboard=-128
    the_blue=-200 the_boiler=-174 the_bookcase=-200 the_bookshelf=-179 the_boot=-94 the_boss=83
    the_bottom=-200 the_bowl=15 the_brass=-94 the_bread=-94 the_break=-94 the_breakfast=-89
    the_brick=-191 the_bridge=-26 the_brochure=-113 the_brown=-170 the_bucket=-113
    the_buffet=-128 the_building=105 the_bulletin=-113 the_bunk=-200 the_bust=-154
    the_cabin=-165 the_cabinet=-183 the_cactus=-142 the_cafe=-128 the_cake=-113 the_candle=-187
    the_candles=-128 the_candy=-94 the_carpet=-200 the_cash=-198 the_ceiling=90 the_cellar=-165
    the_center=-165 the_cereal=-113 the_chair=19 the_chairs=-200 the_chandelier=-200
    the_changing=-154 the_chapel=-8 the_charging=7 the_chart=-113 the_checkout=-94
    the_chess=-113 the_chest=-94 the_chief=200 the_chimney=-94 the_china=-128 the_christmas=-113
    the_church=-42 the_classroom=-154 the_cloakroom=-8 the_clock=-200 the_closed=-174
    the_closest=-128 the_closet=-125 the_coat=-200 the_coats=-113 the_coffee=-200
    the_column=-104 the_columns=-94 the_computer=-113 the_concierge=-113 the_conference=-200
    the_confessional=-113 the_contrary=200 the_control=98 the_copier=-198 the_corner=-200
    the_corridor=-200 the_costumes=-94 the_couch=56 the_counter=-200 the_courtyard=-154
    the_crib=-200 the_cubbies=15 the_curtain=-200 the_curved=-165 the_dance=-128 the_dark=-8
    the_dartboard=-142 the_deck=-200 the_deep=-113 the_deer=-113 the_den=-183
    the_description=200 the_desk=-200 the_desks=-165 the_dining=-200 the_dinosaur=-128
    the_direction=43 the_directions=200 the_dishwasher=-200 the_display=-142 the_distance=-165
    the_doctor's=52 the_dog=-56 the_door=-145 the_doormat=-174 the_doors=-96 the_doorway=-200
    the_double=-200 the_dresser=-200 the_dressing=-191 the_drinking=-113 the_drum=-174
    the_drums=-128 the_dryer=-174 the_easel=-165 the_edge=-200 the_elevator=-192
    the_elevators=-165 the_end=-116 the_engine=-94 the_entrance=-67 the_entryway=-195
    the_escalator=-200 the_exercise=-159 the_exit=-40 the_eye=-113 the_family=-148 the_far=-200
    the_fence=-113 the_fern=-128 the_fifth=-113 the_filing=-113 the_fire=-21 the_fireplace=-200
    the_first=-42 the_fish=-200 the_five=-94 the_floor=-21 the_flower=-174 the_flowers=-113
    the_folding=-94 the_following=200 the_font=-128 the_foosball=-94 the_foot=-200
    the_fountain=-200 the_four=-159 the_fourth=-19 the_foyer=-116 the_freezer=-165
    the_french=-200 the_fridge=-193 the_front=-122 the_fruit=-8 the_full=-94 the_fuse=15
    the_gallery=-154 the_game=-159 the_gap=-128 the_garage=-69 the_garden=14 the_gas=-113
    the_gate=-200 the_generator=-94 the_giant=-94 the_gift=-154 the_glass=-184 the_globe=-200
    the_goal=200 the_gold=-128 the_grandfather=-179 the_grass=-113 the_gray=-195 the_green=-192
    the_grey=-174 the_grill=-200 the_guest=-200 the_guitar=-113 the_gumball=-113 the_gym=-119
    the_half=-113 the_hall=-168 the_hallway=-200 the_handrail=-113 the_harp=-191
    the_harpsichord=-113 the_hat=-142 the_hatch=-154 the_hay=-94 the_head=190 the_heavy=-94
    the_hedge=-94 the_high=-174 the_hooks=-94 the_horse=-128 the_hospital=20 the_hot=-200
    the_hotel=-10 the_house=58 the_ice=-200 the_inner=-94 the_instruction=200 the_iron=-154
    the_ironing=-174 the_island=-183 the_jacuzzi=-135 the_jukebox=-142 the_keyboard=-8
    the_kitchen=-88 the_kitchenette=-26 the_l=-94 the_ladder=-200 the_lady=-94 the_lamp=-200
    the_landing=-200 the_large=-200 the_last=30 the_laundry=-200 the_leather=-200 the_left=-183
    the_leftmost=-94 the_letter=100 the_library=-128 the_life=-154 the_lifeboat=-94
    the_lifeboats=-113 the_lifebuoy=-94 the_lifeguard=-94 the_lift=-12 the_light=-142
    the_linen=-200 the_list=200 the_little=-200 the_living=-48 the_lobby=-200 the_locker=-94
    the_lockers=-200 the_loft=-56 the_long=-132 the_lounge=-200 the_low=-94 the_lower=-113
    the_lunch=-94 the_machine=-183 the_mailbox=-154 the_mailboxes=-174 the_main=-128
    the_mannequin=-142 the_map=200 the_marble=-200 the_massage=-105 the_master=-154 the_mat=-157
    the_metal=-200 the_meteorite=-94 the_microwave=-183 the_middle=-136 the_milk=-94
    the_mirror=-200 the_mirrored=-113 the_mirrors=-142 the_mop=-142 the_moving=-128 the_mud=-179
    the_museum=-26 the_music=-128 the_narrow=-154 the_nave=-94 the_nearest=-40
    the_newspapers=-113 the_next=48 the_nightstand=-174 the_notice=-94 the_number=30
    the_nurse's=-174 the_nursery=-200 the_nurses=-128 the_object=200 the_office=-200 the_old=80
    the_one=-27 the_ones=-94 the_open=-200 the_opening=-174 the_opposite=200 the_orange=-198
    the_organ=-128 the_other=64 the_ottoman=-165 the_outside=-128 the_oval=-94 the_oven=-150
    the_owner=200 the_painting=-159 the_pantry=-143 the_passage=-128 the_path=26 the_patio=-200
    the_penguin=15 the_people=-11 the_person=200 the_pews=-165 the_phone=-67 the_photos=-128
    the_piano=-200 the_picture=13 the_pictures=-94 the_pillar=-198 the_pinball=-113
    the_ping=-142 the_pink=-135 the_place=200 the_plan=200 the_plant=-200 the_plaque=-165
    the_playroom=-142 the_plunge=-165 the_podium=-113 the_police=200 the_pool=-200
    the_popcorn=-128 the_porch=-200 the_portrait=-154 the_poster=67 the_potted=-200
    the_pottery=-94 the_pretty=-94 the_printer=-174 the_pulpit=-142 the_puppet=-113
    the_purple=-200 the_rack=-174 the_radiator=-165 the_rail=-183 the_railing=-200 the_rain=15
    the_ramp=-200 the_reading=-113 the_reception=-200 the_record=-113 the_red=-184
    the_refrigerator=-200 the_remaining=43 the_rest=200 the_restaurant=-113 the_reverse=200
    the_revolving=-165 the_right=-160 the_robot=-191 the_rocking=-191 the_roof=19 the_room=-154
    the_rope=-165 the_round=-200 the_route=200 the_row=-200 the_rowing=-94 the_rows=-94
    the_rug=-200 the_run=200 the_safety=200 the_salad=-94 the_same=-18 the_sandbox=-94
    the_sauna=-200 the_scale=-200 the_school=-94 the_science=15 the_screen=-174
    the_scullery=-113 the_sculpture=-113 the_second=-162 the_sentence=200 the_service=100
    the_set=-128 the_sewing=-154 the_shelf=-200 the_shelves=-128 the_shiny=-142 the_shoe=-200
    the_shoes=-128 the_shop=-96 the_shopping=-113 the_short=-128 the_shower=-200
    the_showers=-154 the_side=-200 the_sign=-29 the_sill=-94 the_silver=-94 the_sink=-200
    the_sinks=-154 the_site=176 the_sitting=-113 the_sixth=-113 the_skeleton=-94
    the_skylight=-56 the_sliding=-200 the_small=-200 the_snack=-94 the_sofa=-27 the_spa=-73
    the_space=-94 the_speaker=100 the_spiral=-200 the_spot=178 the_square=-84 the_stack=-113
    the_stacked=-128 the_stage=-162 the_stained=-113 the_staircase=-200 the_stairs=-92
    the_stairway=-200 the_start=200 the_statue=-200 the_steam=-142 the_steel=-113 the_steps=-145
    the_stone=-200 the_stool=-169 the_stools=-113 the_stop=190 the_store=-94 the_stove=-200
    the_striped=-200 the_study=-200 the_suit=-142 the_sun=-187 the_sunken=-94 the_sunroom=-165
    the_supervisor=200 the_swing=-200 the_swinging=-154 the_t=-154 the_table=-54 the_tables=-142
    the_tall=-137 the_tan=-148 the_tape=-94 the_tapestry=-135 the_task=200 the_tea=-113
    the_teacher's=-142 the_telephone=-94 the_telescope=-174 the_television=-195 the_terrace=-191
    the_text=200 the_theater=-191 the_third=-179 the_three=-200 the_threshold=-198
    the_throne=-165 the_ticket=-183 the_tile=-128 the_tiles=-113 the_tiny=-128 the_toilet=-43
    the_toilets=-94 the_top=-200 the_towel=-183 the_towels=-113 the_tower=-26 the_toy=-142
    the_train=15 the_trash=-148 the_treadmill=-200 the_treadmills=-142 the_tree=-88 the_trip=200
    the_trophies=-94 the_trophy=-174 the_trunk=-113 the_tub=-200 the_turns=200
    the_turnstile=-154 the_tv=-200 the_two=-145 the_typewriter=-94 the_umbrella=-145
    the_unit=200 the_user=200 the_utility=-148 the_vacuum=-113 the_vanity=-191 the_vase=-200
    the_vault=15 the_velvet=-94 the_vending=-200 the_very=7 the_vestibule=-94 the_volcano=-94
    the_waiting=-121 the_walk=198 the_wall=-63 the_walls=59 the_wardrobe=-200 the_washer=-159
    the_washing=-200 the_water=-200 the_way=-9 the_weight=-128 the_well=-128 the_whale=-94
    the_wheelchair=-94 the_while=187 the_white=-200 the_whiteboard=-200 the_whole=129
    the_wicker=-195 the_wigs=-113 the_window=-200 the_windows=-165 the_wine=-200 the_wobbly=-94
    the_wood=-94 the_wooden=-200 the_word=156 the_words=200 the_workbench=-142 the_wrong=200
    the_yard=-142 the_yellow=-155 theater=-200 theater_room=-154 theater_with=-94 theatre=-94
    their=192 theirs=86 them=-58 them_=-45 them_all=100 them_and=-183 them_on=-128 them_to=-154
    themselves=-72 then=-200 then_a=-183 then_after=-84 then_another=-113 then_as=-84
    then_at=-142 then_bear=-104 then_climb=-104 then_come=-113 then_continue=-121
    then_cross=-200 then_descend=-121 then_down=-94 then_enter=-142 then_follow=-195
    then_go=-200 then_hang=-113 then_head=-174 then_i=-94 then_immediately=-113 then_in=-94
    then_it's=-191 then_keep=-174 then_left=-200 then_look=-94 then_make=-104 then_move=-121
    then_once=-121 then_out=-183 then_pass=-200 then_past=-200 then_proceed=-165 then_right=-200
    then_slightly=-94 then_stand=-72 then_step=-159 then_stop=-200 then_straight=-94
    then_take=-200 then_that=-94 then_the=-154 then_there's=-183 then_through=-128 then_to=-113
    then_turn=-200 then_up=-113 then_veer=-72 then_wait=-200 then_walk=-200 then_when=-121
    then_you=-200 then_you'll=-128 then_you're=-78 there=-42 there'll=-113 there'll_be=-113
    there's=-173 there's_a=-157 there's_the=-183 there_=-50 there_and=-69 there_are=-56
    there_but=-94 there_is=10 there_make=-94 there_should=-174 there_so=-128 there_take=-94
    there_turn=-113 there_was=135 there_will=-198 there_without=-94 there_you=-94 thereafter=-42
    thereof=-42 theres=-42 these=200 these_commands=200 they=200 they'll=86 they're=-183
    they've=15 they_are=200 they_turn=-94 they_were=200 thick=-42 thin=-8 thing=-4 thing_=-8
    thing_is=18 thing_number=-94 thing_to=-67 thing_you=18 things=200 think=124 think_of=160
    thinking=132 third=-174 third_=-191 third_desk=-94 third_door=-33 third_right=-104
    third_row=-142 third_window=-142 thirdly=-42 this=200 this_=200 this_at=197
    this_building=200 this_house=200 this_is=200 this_one=50 this_room=7 this_route=200
    this_run=200 this_says=200 this_sentence=200 this_step=119 this_task=200 this_text=200
    those=-200 those_=-94 those_and=-94 though=-42 three=-99 three_=-128 three_doors=-183
    three_is=-94 three_o'clock=-94 three_stairs=-148 three_stairway=-58 three_steps=-200
    threshold=-198 threshold_and=-198 throne=-191 throne_=-113 throne_and=-128 through=-200
    through_=-183 through_90=-94 through_a=-8 through_and=-154 through_door=-94 through_it=-90
    through_that=-191 through_the=-200 through_there=-94 throughout=130 throw=200 throwing=86
    thru=-94 thumping=-42 tick=-42 ticked=172 ticket=-200 ticket_booth=-113 ticket_machine=-113
    ticks=-42 tiddles=86 tie=86 tied=-72 tiger=15 tight=-94 tile=-200 tiled=-72 tiles=-183
    tiles_=-128 till=-200 till_the=-200 till_you=-200 time=177 time_and=-113 time_you=200
    times=132 times_=190 tinsel=-72 tiny=-200 tiny_bit=-94 tiny_chairs=-94 tiptoe=-94 tiptoes=86
    tired=86 titchy=-42 to=-17 to_=200 to_a=-200 to_an=-165 to_be=200 to_begin=-94 to_carry=200
    to_disregard=200 to_do=91 to_drop=132 to_end=200 to_face=-200 to_find=103 to_follow=190
    to_gate=-113 to_get=-112 to_go=80 to_it=-118 to_its=-33 to_keep=-113 to_leave=200
    to_look=-198 to_move=190 to_open=-142 to_pass=-142 to_put=15 to_read=149 to_return=200
    to_say=-8 to_see=38 to_sit=61 to_stand=-94 to_stop=106 to_take=112 to_tell=200 to_that=-128
    to_the=-115 to_turn=-57 to_undo=112 to_wait=100 to_walk=181 to_where=149 to_you=200
    to_your=-78 tock=-42 today=200 today's=-154 today_=200 toddle=-72 todo=172 toes=-72
    together=19 together_=90 toilet=-67 toilet_=49 toilet_ahead=-58 toilet_and=-200 toilets=-94
    told=200 told_me=200 told_to=200 tolerance=-42 tomatoes=-72 tomb=-72 tomorrow=172 tonight=86
    too=94 too_=115 too_far=-96 took=-42 tool=-94 tool_bench=-94 toolbox=-42 tools=15 top=-200
    top_=-200 top_and=-2 top_go=-94 top_of=-200 top_turn=-113 top_you'll=-94 toss=172 touch=-154
    touch_the=-113 touching=172 toward=-200 toward_the=-200 towards=-141 towards_it=-94
    towards_the=-198 towel=-200 towel_=-113 towel_rack=-191 towels=-191 towels_=-174 tower=-78
    toy=-198 toy_chest=-113 toys=-113 trace=172 track=-94 tractor=-8 tractor_=-94 trade=172
    traffic=163 train=-42 trains=-72 trajectory=-42 trampoline=-72 transition=-42 translate=-42
    translating=172 translation=-72 trap=200 trash=-198 trash_can=-198 travel=137 travels=-42
    traverse=-94 tray=-42 tread=-42 treadmill=-200 treadmill_=-198 treadmill_and=-113
    treadmill_turn=-58 treadmills=-165 treadmills_=-94 treads=-113 treasure=90 treasure's=86
    treat=200 treat_all=200 treat_the=200 tree=-125 tree_=-198 tree_and=-113 tree_in=15
    treehouse=-72 trees=-72 trestle=-72 trip=200 trolley=-42 trolleys=-72 trophies=-128
    trophies_=-94 trophy=-191 trophy_cabinet=-113 trophy_case=-154 trot=-42 trotting=-42
    trough=-72 trucks=-42 true=172 trun=-142 trunk=-113 trust=200 try=-94 trying=132 tub=-200
    tub_=-200 tub_and=-142 tub_to=-84 tucked=-42 tuesday=86 tuesdays=86 tulips=-72 tumble=-42
    tummy=-42 tummy's=86 tune=-72 tuner=-42 tunnel=86 tunr=172 turn=-94 turn_=95 turn_90=-200
    turn_and=65 turn_around=-69 turn_at=-142 turn_away=90 turn_back=200 turn_go=100
    turn_into=-128 turn_is=200 turn_left=-200 turn_right=-180 turn_round=7 turn_sharp=-198
    turn_slightly=-200 turn_so=-94 turn_to=-200 turn_toward=-94 turn_until=-94 turn_your=-200
    turned=90 turning=29 turning_on=149 turns=200 turns_=200 turnstile=-183 turnstile_=-113
    turnstile_and=-94 turnstiles=-72 tv=-200 tv_=-200 tv_and=-142 twang=-42 twelve=-198
    twelve_=-94 twice=106 twice_=100 twice_without=176 twin=15 twins=86 twirl=200 twirl_in=197
    twist=-42 twit=-42 two=-102 two_=103 two_beds=-94 two_bookshelves=-94 two_computer=-113
    two_couches=-94 two_doors=-200 two_flights=-165 two_floors=-142 two_hallways=-94
    two_long=-113 two_paintings=-94 two_pillars=-113 two_rooms=-142 two_rows=-113 two_sinks=-113
    two_staircases=15 two_steps=-23 two_three=-94 type=-72 typed=172 typewriter=-113
    typewriter_=-94 typing=130 u=-200 u_turn=-200 uh=-142 um=-165 umbrella=-162 umbrella_=-94
    umbrella_stand=-119 uncle=86 under=-69 under_it=-165 under_the=-200 underneath=59
    understand=172 understood=172 undo=200 undo_what=200 unicorn=-72 uniform=-42 unit=200
    unit_shall=190 units=197 unless=172 unlike=86 unlit=-42 unspecified=-42 until=-35 until_i=78
    until_it=-191 until_the=-22 until_you=-113 until_you're=-183 unusual=-42 up=-101 up_=37
    up_a=-142 up_all=-200 up_and=-40 up_at=-94 up_both=-56 up_by=-94 up_in=47 up_it=-128
    up_one=-200 up_or=59 up_the=-200 up_them=-198 up_there=150 up_those=-113 up_three=-200
    up_to=-200 up_two=-125 up_with=78 update=200 updated=172 upholstery=-42 upon=-42 upper=-42
    ups=-72 upside=130 upstairs=33 upstairs_=103 upstairs_in=-113 upward=86 upwards=-42 urer=172
    urn=-72 us=78 us_=-94 use=99 use_the=52 use_to=15 used=99 used_to=38 user=200 user's=172
    using=-187 using_the=-187 usually=-42 utility=-148 utility_room=-148 vacuum=-183
    vacuum_cleaner=-128 valid=200 van=44 vanity=-200 vanity_=-72 vanity_and=-135 vanitys=-23
    vase=-187 vase_=-195 vase_of=-94 vase_on=-135 vases=-165 vault=19 vault_=15 vector=-42
    veer=-200 veer_a=-94 veer_left=-142 veer_right=-104 veering=-42 vegetables=-42 vehicle=-42
    velocity=-42 velvet=-94 velvet_rope=-94 vending=-200 vending_machine=-200 veranda=-72
    verb=200 verification=-42 version=200 vertical=-72 very=-46 very_first=100 vessel's=-42
    vestibule=-94 vestry=-72 vests=-42 via=-191 via_the=-154 view=-174 view_=-94 vineyard=-42
    vip=86 vise=-72 visibility=86 visit=-94 visually=-42 voice=200 void=200 void_=200
    void_so=112 voids=172 volcano=-94 voted=172 w=-142 waffle=-72 waffles=86 waist=-42 wait=-55
    wait_=-32 wait_at=-200 wait_beside=-154 wait_by=-127 wait_for=156 wait_here=86 wait_in=-200
    wait_just=-179 wait_near=-187 wait_next=-200 wait_outside=105 wait_there=-200
    wait_under=-165 waiting=-43 waiting_area=-135 waiting_room=-94 wake=-42 wakes=172 wakey=86
    wales=86 walk=-133 walk_=200 walk_3=-113 walk_a=-73 walk_across=-200 walk_ahead=-165
    walk_all=-142 walk_along=-177 walk_alongside=-200 walk_around=-200 walk_away=-27
    walk_back=175 walk_behind=-94 walk_beside=-94 walk_between=-200 walk_by=-200 walk_down=-200
    walk_forward=-200 walk_from=-142 walk_in=19 walk_inside=-200 walk_into=-54 walk_on=-200
    walk_out=-141 walk_over=-128 walk_past=-200 walk_round=-94 walk_straight=-200 walk_the=-19
    walk_through=-200 walk_to=-149 walk_toward=-174 walk_towards=-79 walk_under=-200
    walk_until=-200 walk_up=-200 walked=130 walking=3 walking_=43 walking_past=-200 walks=200
    walkway=-191 walkway_to=-113 wall=-59 wall_=-121 wall_and=-35 wall_ends=-94 wall_of=78
    wall_on=-52 wall_past=-113 wall_that=100 wall_that's=-94 wall_to=30 wall_with=-183
    wallpaper=-94 walls=-16 walls_=33 walls_and=-113 wally=86 walnut=-42 wander=59 want=-56
    want_=-154 want_the=-200 want_to=-125 want_you=66 wanted=122 wants=200 wants_you=200 ward=78
    wardrobe=-83 wardrobe_=-122 wardrobe_and=-104 warm=-8 warmer=-72 warn=-42 warranty=172
    was=200 was_a=116 wash=-8 washer=-200 washer_=-135 washer_and=-104 washing=-200
    washing_machine=-200 washing_machines=-84 wasn't=-42 wasteful=-42 watch=-78 watches=-42
    watching=-42 watchtower=86 water=-200 water_cooler=-200 water_fountain=-174
    water_heater=-128 wave=-154 waving=86 waxed=-42 way=50 way_=140 way_around=-113
    way_down=-198 way_into=-94 way_is=200 way_of=-195 way_out=-128 way_over=-94 way_round=200
    way_through=-94 way_to=-74 way_up=-94 way_you=90 waypoint=119 we=134 we'd=-42 we'll=-165
    we're=54 we're_going=4 we're_not=100 we've=100 we've_got=15 we_=90 we_are=200 we_can=-94
    we_had=15 we_have=170 weak=86 wearing=90 weather=86 weave=-42 weaving=-42 wedding=-72
    wedge=-42 wee=15 week=86 week's=86 weighing=-72 weight=-142 weight_bench=-94 weight_rack=-94
    weights=-72 welcome=-128 welcoming=-42 well=48 well_=-56 wellies=-72 went=-42 wept=86
    were=200 were_mirrored=200 west=86 western=-42 westward=-42 wet=59 whale=-113 what=200
    what's=86 what_a=163 what_i=200 what_is=200 what_it=190 what_the=200 what_they=190
    what_this=200 what_you=200 whatever=200 whatever_is=200 wheee=-42 wheel=43 wheel_=78
    wheelbarrow=-72 wheelchair=-94 wheelchairs=-113 wheels=127 wheels_=43 when=-93 when_the=-5
    when_you=-122 when_you're=-129 when_you've=-113 whenever=200 whenever_you=200 where=85
    where_a=160 where_it=180 where_people=-128 where_the=-200 where_there's=-94 where_they=168
    where_you=159 where_you'll=-94 wherever=200 wherever_it=200 which=-13 which_has=-42
    which_is=-153 which_you=137 whichever=-113 while=200 while_=176 whirl=172 whisky=-42
    whisper=86 whispered=172 white=-200 white_door=-183 white_tiles=-113 white_towels=-113
    whiteboard=-200 whiteboard_=-174 whiteboard_turn=-94 whizz=-72 who=200 who's=132 whoa=-42
    whoever=200 whole=91 whole_way=81 whom=172 whoopsie=-42 whopping=-42 whose=-72 why=44
    wicker=-200 wicker_bench=-84 wide=-72 wider=-142 width=130 wigs=-113 will=-63 will_be=-67
    will_see=-200 willow=-72 win=15 winch=-72 wind=86 winders=-42 window=-200 window's=-42
    window_=-200 window_and=-64 window_at=-128 window_in=-35 window_is=-128 window_seat=-165
    window_then=-94 window_turn=-121 window_with=-94 windows=-198 windows_=-198 windows_and=-94
    windows_on=-128 windowsill=-42 wine=-178 wine_cellar=-154 wine_fridge=-113 wine_rack=-200
    wing=44 wink=-72 winner=-42 wipe=172 wishing=-72 with=-93 with_a=-141 with_all=-128
    with_an=-26 with_flowers=-94 with_full=176 with_glass=-128 with_green=-94 with_it=78
    with_its=15 with_lots=-142 with_no=-113 with_round=-113 with_the=-118 with_three=-128
    with_two=-200 with_windows=-113 with_you=90 with_your=3 withdrawn=200 withdrawn_this=132
    within=67 without=-16 without_entering=-165 without_going=-174 without_moving=176
    without_stopping=100 witness=-72 wlak=-142 wobbly=-113 woke=172 woman=-113 women=-42
    won't=15 wonderful=44 wood=-200 wood_stove=-128 wooden=-200 wooden_bench=-94
    wooden_door=-200 wooden_floor=-191 wooden_pews=-113 wooden_stairs=-94 wooden_table=-142
    woof=86 word=200 words=200 work=200 workbench=-154 workbench_=-94 working=-72 workshop=-72
    worry=15 would=137 would_you=-10 wouldn't=44 wow=15 wreath=-113 wristwatch=-42 write=172
    written=200 written_=200 written_next=197 wrong=200 wrong_way=200 wrote=200 x=184
    xylophone=-72 yard=-142 yard_=-113 yaw=100 yeah=187 year=163 years=-42 yell=-42 yellow=-99
    yellow_door=15 yellow_line=-142 yellow_lines=-94 yep=-42 yes=15 yesterday=132 yet=15 yet_=15
    yew=-42 yo=172 yoga=-72 yonder=-42 you=58 you'd=92 you'll=-200 you'll_be=-146
    you'll_come=-191 you'll_find=-191 you'll_go=-94 you'll_notice=-94 you'll_pass=-165
    you'll_see=-200 you'll_spot=-94 you'll_stop=-94 you'll_want=-183 you're=-101 you're_at=-200
    you're_done=-183 you're_facing=-128 you're_going=-143 you're_in=-97 you're_inside=15
    you're_looking=-174 you're_not=133 you're_out=-94 you're_outside=-113 you're_standing=-183
    you're_there=-183 you've=-22 you've_gone=-56 you've_got=-128 you_=79 you_a=185 you_and=5
    you_are=87 you_at=19 you_began=200 you_begin=103 you_bump=-128 you_came=40 you_can=-53
    you_can't=-40 you_come=-103 you_did=200 you_do=200 you_don't=-42 you_enter=-169
    you_find=-113 you_for=190 you_get=-126 you_go=-146 you_have=118 you_hear=200 you_hit=59
    you_hold=100 you_in=110 you_into=-94 you_is=100 you_just=-11 you_know=180 you_leave=119
    you_like=152 you_make=100 you_may=43 you_might=-26 you_must=200 you_need=39 you_on=170
    you_out=78 you_pass=9 you_please=-94 you_reach=-194 you_read=200 you_remember=90 you_see=-83
    you_shall=-94 you_should=58 you_so=160 you_stand=143 you_stop=-200 you_take=-174
    you_that=200 you_the=200 you_then=-84 you_to=196 you_turn=49 you_undo=112 you_up=160
    you_wait=-113 you_walk=-4 you_want=-200 you_were=200 you_will=-200 your=18 your_back=-200
    your_destination=-142 your_developer=200 your_feet=-94 your_head=78 your_left=-200
    your_mission=100 your_operator=200 your_orders=200 your_own=200 your_right=-200
    your_route=200 your_second=-94 your_steps=36 your_stop=-94 your_stopping=-142 your_way=-200
    your_wheels=200 yours=81 yourself=16 yourself_and=-94 yourself_at=-94 yourself_in=-113
    yummy=-42 zero=81 zone=-142 zoo=86
    """
)
WORDS = {term: int(odds) / 100 for term, odds in (w.split("=") for w in _WORDS)}
