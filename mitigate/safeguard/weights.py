"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -0.597,
    "orders": 0.369,
    "text": 0.604,
    "annul": 0.239,
    "invert": -0.050,
    "case": 0.627,
    "halt": 0.288,
    "machine": 0.274,
    "role": 0.239,
    "authority": 0.416,
    "haste": -0.071,
    "if": -0.094,
    "me": -0.130,
    "you": 0.134,
    "third": 0.268,
    "past": 0.111,
    "not": 0.057,
    "here": -0.013,
    "time": 0.262,
    "go": 0.076,
    "has orders": 0.264,
    "has text": 0.113,
    "has annul": 0.238,
    "has invert": 0.029,
    "has case": 0.967,
    "has halt": -0.210,
    "has machine": 0.203,
    "has role": 0.304,
    "has authority": 0.367,
    "has haste": -0.067,
    "has if": 0.211,
    "has me": 0.162,
    "has you": -0.293,
    "has third": 0.081,
    "has past": 0.334,
    "has not": -0.083,
    "has here": -0.335,
    "has time": 0.201,
    "has go": 0.119,
    "hidden": 0.282,
    "alike": 2.774,
    "wide": 1.411,
    "spelled": 2.226,
    "leet": 2.380,
    "code": 0.308,
    "cipher": 2.219,
    "unknown": 0.119,
    "alien": 0.037,
    "foreign letters": 0.255,
    "late verb": 0.103,
    "no verb": 0.248,
    "on route": -0.022,
    "other things": 0.286,
    "nothing": 0.278,
    "turns": 0.073,
    "places": -0.047,
    "no place": 0.789,
    "length": 0.411,
    "short": -0.365,
    "commas": -0.469,
    "asks": 0.243,
    "exclaims": 0.331,
    "quoted": 1.225,
    "quote in": -0.167,
    "markup": 2.927,
    "role of": -0.026,
    "reported": 0.059,
    "self": 0.349,
    "about": 1.024,
    "back to text": -0.400,
    "elsewhere": -0.118,
    "annul orders": 0.131,
    "invert orders": 0.680,
    "case orders": 0.034,
    "not orders": 0.053,
    "halt nowhere": -0.303,
    "halt here": 0.400,
    "not go": 0.015,
    "both sides": 0.619,
    "case not": -0.291,
    "case go": 0.595,
    "case halt": 0.292,
    "me past": 0.067,
    "third past": -0.139,
    "you role": 0.088,
    "authority said": 0.329,
    "machine you": 0.207,
    "me no place": -0.190,
    "past no you": 0.234,
    "annul place": -0.115,
    "not place": 0.468,
    "if place": -0.434,
    "words": 0.820,
    "pairs": 0.547,
    "worst words": 0.028,
    "best words": 0.622,
}
CONTEXT: dict[str, float] = {
    "bias": 0.686,
    "own": 0.876,
    "first": -0.800,
    "last": 0.085,
    "stops early": 1.465,
    "stops before all": 0.375,
    "denies the rest": -0.300,
    "repeats the rest": -0.458,
    "neighbour": 1.042,
    "neighbours": 1.643,
    "alone": -1.307,
    "most": -2.137,
}
PART: dict[str, float] = {
    "bias": -1.269,
    "whole": -0.064,
    "orders": 0.121,
    "text": 0.469,
    "annul": 0.466,
    "invert": 0.221,
    "case": 0.470,
    "halt": 0.613,
    "machine": 0.540,
    "role": 0.108,
    "authority": 0.708,
    "haste": 0.043,
    "if": -0.256,
    "me": -0.963,
    "you": -0.132,
    "third": 0.018,
    "past": 0.003,
    "not": -0.336,
    "here": 0.012,
    "time": 0.019,
    "go": 0.421,
    "has orders": 0.021,
    "has text": 0.562,
    "has annul": 0.460,
    "has invert": 0.221,
    "has case": 0.609,
    "has halt": 0.332,
    "has machine": 0.540,
    "has role": 0.108,
    "has authority": 0.708,
    "has haste": 0.043,
    "has if": -0.091,
    "has me": -0.785,
    "has you": -0.384,
    "has third": 0.284,
    "has past": 0.093,
    "has not": -0.217,
    "has here": -0.582,
    "has time": 0.065,
    "has go": -0.190,
    "hidden": 2.332,
    "alike": 3.669,
    "wide": 0.000,
    "spelled": 0.608,
    "leet": 3.187,
    "code": 0.000,
    "cipher": 2.488,
    "unknown": 1.725,
    "alien": 0.567,
    "foreign letters": 0.268,
    "late verb": -0.110,
    "no verb": -0.600,
    "on route": 0.235,
    "other things": -0.215,
    "nothing": 0.167,
    "turns": 0.443,
    "places": -0.185,
    "no place": 0.077,
    "length": -0.475,
    "short": -0.283,
    "commas": 1.535,
    "asks": -0.759,
    "exclaims": -0.612,
    "quoted": 0.847,
    "quote in": 2.148,
    "markup": 0.000,
    "role of": -0.068,
    "reported": 0.290,
    "self": -0.165,
    "about": 0.405,
    "back to text": -0.223,
    "elsewhere": 0.979,
    "annul orders": 0.537,
    "invert orders": 0.835,
    "case orders": 0.216,
    "not orders": 0.260,
    "halt nowhere": 0.462,
    "halt here": 0.126,
    "not go": 0.436,
    "both sides": 1.032,
    "case not": 0.121,
    "case go": 0.313,
    "case halt": 0.085,
    "me past": -0.104,
    "third past": 0.208,
    "you role": -0.176,
    "authority said": 0.251,
    "machine you": 0.217,
    "me no place": -0.317,
    "past no you": -0.092,
    "annul place": 0.101,
    "not place": 0.472,
    "if place": -0.022,
    "words": 1.444,
    "pairs": 0.951,
    "worst words": -0.124,
    "best words": -0.658,
}
FRONT: dict[str, float] = {
    "bias": -2.789,
    "universal": 1.711,
    "text": 2.314,
    "person": 0.091,
    "modal": 0.316,
    "negation": 0.250,
    "style": 0.208,
    "unknown": 4.405,
    "late_verb": 0.781,
    "no_verb": -0.116,
    "landmarks": -0.279,
    "no_landmark": 0.636,
    "directions": -0.888,
    "commas": -1.279,
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
    0=91 07=172 1=-200 10=-140 12=-50 120=-41 13=172 135=-41 14=-41 15=-41 16=-41 18=-41
    180=-163 180_degrees=-163 1_m=-127 2=-200 20=-71 204=-140 214=-71 270=-41 2_=-93 2_m=-197
    2_meters=-111 2_nd=-93 3=-200 30=-93 306=-71 308=-41 310=-41 3_5=-163 3_is=-93 3_m=-111
    3_meters=-111 3_step=-71 4=8 408=-41 45=-71 4_=-41 4_m=-172 4_stop=-140 5=-200 5_m=-111
    5_meters=-111 6=-93 64=172 7=-111 7741=172 8=-41 9=-152 90=-200 90_degrees=-200 9_m=-111
    _=200 _1=-140 _2=-93 _3=-140 _4=-93 _a=107 _action=161 _actually=120 _advance=-140 _after=10
    _all=200 _alright=91 _always=196 _and=-137 _anyway=-25 _are=122 _as=167 _ascend=-93
    _assistant=200 _at=-59 _back=-197 _be=-41 _bear=-200 _bedroom=-93 _before=52 _begin=-13
    _behind=-111 _between=31 _beyond=-93 _bottom=-111 _bound=-93 _bullet=-93 _but=134 _by=200
    _can=16 _cancel=200 _climb=-200 _come=-200 _consider=190 _continue=-89 _could=13 _count=-93
    _cross=-200 _descend=-147 _disregard=162 _do=111 _don't=0 _door=-163 _down=-17 _each=188
    _end=51 _enter=-200 _every=175 _everything=158 _exit=-200 _face=-87 _facing=-200 _find=-200
    _first=-172 _follow=-111 _for=200 _forget=128 _from=-22 _front=79 _get=-99 _go=-200
    _good=170 _guess=91 _hallway=-93 _halt=90 _hang=-111 _he=91 _head=8 _heading=-111 _hello=200
    _here=-65 _here's=16 _hey=154 _hi=200 _hold=5 _how's=163 _i=133 _i'd=141 _i'll=171 _i'm=113
    _i've=-7 _if=108 _ignore=122 _imagine=123 _in=65 _inside=-111 _instead=-200 _into=-111
    _is=200 _it=122 _it'll=-111 _it's=71 _its=-93 _job=-111 _just=51 _keep=-88 _kindly=200
    _ladder=-93 _lap=-93 _leave=-194 _left=-27 _leg=-140 _let's=-2 _line=-127 _locate=-111
    _look=-176 _make=-151 _message=200 _move=-200 _my=188 _never=200 _new=200 _next=-200 _no=166
    _nobody=53 _not=-55 _nothing=200 _notice=200 _now=-141 _objective=-93 _of=-93 _off=-7
    _oh=200 _okay=-105 _on=-97 _once=-26 _one=-66 _only=154 _open=-93 _our=200 _out=-200
    _override=91 _par=-111 _pass=-200 _past=-200 _perform=190 _phase=-140 _plan=-93 _please=200
    _proceed=-200 _quick=-93 _read=200 _remain=120 _remember=200 _return=120 _reverse=-17
    _right=-172 _rotate=-93 _route=-163 _say=153 _second=-172 _see=-181 _sharp=-93 _sit=101
    _skip=97 _slide=101 _so=-21 _somebody=200 _sorry=100 _spin=45 _stage=-111 _stairs=-163
    _stand=-59 _start=-200 _starting=-177 _stay=128 _step=-200 _stop=-183 _straight=-200
    _swap=200 _swing=-93 _switch=91 _system=200 _take=-81 _task=198 _tell=163 _thank=200
    _that=126 _that's=-74 _the=137 _then=-200 _there=6 _there'll=-93 _there's=-153 _they=115
    _thing=-93 _third=-127 _this=200 _three=-8 _through=-127 _to=-3 _train=-93 _treat=200
    _turn=-144 _two=-78 _under=200 _until=200 _up=-200 _use=-181 _user=200 _veer=-181 _wait=-87
    _walk=-200 _we=134 _we'll=-127 _we're=-41 _we've=101 _well=91 _what=163 _whatever=200
    _when=-46 _whenever=180 _where=97 _with=-75 _without=-189 _would=16 _x=200 _yeah=163 _you=10
    _you'll=-200 _you're=-200 _your=119 a=-28 a_balcony=-82 a_bathroom=-193 a_bathtub=-25
    a_bear=16 a_bed=-200 a_bedroom=-111 a_bench=-60 a_big=-200 a_bit=5 a_black=-158 a_blue=-76
    a_bookcase=-54 a_bookshelf=-93 a_bowl=-111 a_brown=-140 a_bunch=-93 a_cabinet=-71 a_cat=101
    a_chair=6 a_chandelier=16 a_chapel=-93 a_circle=173 a_closed=-93 a_closet=-120 a_comfy=-93
    a_couch=20 a_couple=-197 a_cross=-93 a_curtain=-103 a_cushion=-172 a_desk=-200 a_dining=-103
    a_dog=-93 a_door=41 a_doorway=-140 a_dresser=4 a_few=17 a_fireplace=-147 a_fish=-134
    a_floor=-127 a_fork=-163 a_fridge=16 a_friendly=-7 a_gift=-93 a_glass=-193 a_good=79
    a_gray=-103 a_green=-31 a_grey=-57 a_half=-181 a_hall=-127 a_hallway=-96 a_hard=-140
    a_hat=-93 a_hole=-93 a_horse=-152 a_huge=-93 a_kitchen=-152 a_ladder=-54 a_lamp=-183
    a_large=-181 a_laundry=-103 a_left=-143 a_lion=-111 a_little=-90 a_lobby=-93 a_long=-120
    a_lot=-93 a_marble=-93 a_metal=-71 a_microwave=-93 a_mirror=13 a_narrow=-111 a_nice=-41
    a_nursery=-93 a_phone=-93 a_piano=-127 a_picture=-163 a_pillar=-93 a_pink=-93 a_plant=-110
    a_pool=-103 a_popcorn=-111 a_potted=-111 a_pretty=-93 a_purple=-41 a_quick=-7 a_railing=-111
    a_really=-93 a_red=-141 a_refrigerator=-111 a_right=-151 a_road=-93 a_robot=45 a_rocking=-93
    a_room=28 a_round=-185 a_row=-163 a_rug=39 a_seat=-163 a_set=-120 a_sharp=-164 a_shelf=-120
    a_shiny=-111 a_ship=-7 a_short=-93 a_sign=31 a_sink=-33 a_slight=-200 a_small=-189
    a_sofa=-76 a_square=-147 a_staircase=85 a_stand=-93 a_stone=-54 a_stool=-93 a_stop=-87
    a_straight=-93 a_striped=-127 a_sweet=-111 a_table=-200 a_tall=-111 a_tan=-120
    a_tapestry=-71 a_technician=200 a_teeny=-111 a_television=-177 a_tiny=-127 a_toilet=-140
    a_towel=-120 a_trash=-82 a_turn=-127 a_tv=-93 a_u=-200 a_vase=-93 a_waiting=-93 a_wall=16
    a_wardrobe=16 a_wee=16 a_white=-120 a_whole=-93 a_wicker=-71 a_window=-200 a_wood=-111
    a_wooden=-147 a_yellow=13 abandon=31 abeam=-41 able=-41 abort=172 about=149 about_the=200
    about_to=200 about_turn=-93 above=200 absolute=86 absolutely=-41 abutment=-41 access=200
    accident=172 accommodation=-41 accomplished=-140 according=172 accordingly=200
    accordingly_=200 accounting=-41 accounts=-41 acquire=-71 across=-200 across_it=-163
    across_the=-200 act=177 acting=200 action=200 action_stop=190 actual=45 actually=120 add=131
    addressee=172 adjacent=-41 adjustment=-41 admin=172 administrator=200 administrator's=-140
    administrator_has=200 admire=-41 admiring=-41 adn=172 adorable=-41 adore=86 advance=-189
    advance_to=-152 adventure=86 advised=132 afford=-41 aft=-93 after=15 after_=91
    after_each=200 after_every=200 after_it=-197 after_that=-189 after_the=-200 after_this=120
    again=-2 again_=96 again_and=60 again_around=-93 again_at=-200 against=139 against_the=139
    agent=172 ago=-41 agree=172 agreed=172 ahead=-197 ahead_=-200 ahead_and=-163 ahead_of=-200
    ahead_to=-111 ahhh=-41 ahoy=86 aid=-140 aim=-41 airlock=-41 aisle=-200 aisle_=-163
    aisle_and=-127 aisle_between=-181 aisle_to=-93 alarm=-197 alcove=-152 alcove_on=-93
    alighting=-41 align=-41 all=128 all_=200 all_around=-140 all_of=118 all_robots=200
    all_that=200 all_the=-72 all_turns=200 all_you=101 alley=-41 allow=197 allow_what=197
    allowed=120 almost=-41 along=-147 along_it=-163 along_that=-93 along_the=-157 along_to=-111
    along_until=-93 alongs=86 alongside=-200 alongside_the=-200 alpha=-71 already=200
    already_=200 alright=91 alrighty=-41 also=-111 altar=-200 altar_=-111 alter=-41 alters=-41
    always=182 always_do=200 always_use=112 am=200 am_the=200 amazing=86 amble=-41 an=12
    an_elevator=-111 an_hour=200 an_office=-152 an_open=-1 an_orange=16 an_oval=-71 an_oven=-71
    an_umbrella=-93 ancelledcay=172 anchor=-71 and=-91 and_a=-98 and_after=-181 and_around=-111
    and_as=-127 and_at=-200 and_back=161 and_bear=-82 and_between=-93 and_carry=-189
    and_climb=-168 and_come=11 and_continue=-200 and_cross=-163 and_do=190 and_don't=-189
    and_down=-70 and_enter=-200 and_exit=-152 and_face=79 and_find=-189 and_finish=190
    and_follow=-200 and_get=-127 and_give=-93 and_go=-147 and_halt=-200 and_hang=-185
    and_head=-200 and_hold=-140 and_i=170 and_i'll=-7 and_in=16 and_into=-200 and_it=-8
    and_it's=-156 and_just=-127 and_keep=-200 and_leave=25 and_left=-181 and_look=-86
    and_make=-200 and_move=-93 and_no=-41 and_not=79 and_on=-152 and_once=-103 and_out=-130
    and_pass=-200 and_past=-87 and_proceed=-57 and_put=-93 and_report=200 and_right=177
    and_round=45 and_say=-111 and_second=-111 and_shut=190 and_stand=64 and_stay=172
    and_step=-177 and_stop=-200 and_straight=-172 and_take=-122 and_that=-9 and_that's=-200
    and_the=-101 and_then=-200 and_there=-111 and_there's=-100 and_through=-200 and_to=-93
    and_toward=-200 and_turn=-200 and_two=-152 and_up=-200 and_veer=-111 and_wait=-94
    and_walk=-200 and_when=-200 and_white=-127 and_you=-73 and_you'll=-200 and_you're=-189
    angel=-41 angle=-152 annotator=172 announces=172 another=108 another_door=-93 answer=172
    anticlockwise=-41 any=194 any_door=200 any_further=200 any_more=185 any_of=198 anyhow=45
    anyone=200 anything=177 anytime=172 anyway=-41 anywhere=200 anywhere_=200 anywho=-41
    apart=-41 apartment=-71 aperture=-71 appearance=-41 appears=172 apples=-111 applies=172
    apply=101 apply_a=101 approach=139 approved=200 approximately=-71 aquarium=-163
    arbitrary=-41 arcade=-71 arch=-200 arch_=-200 arch_and=-197 arched=-93 arches=-41
    archive=-71 archway=-200 archway_=-200 archway_and=-163 archway_on=-93 archway_turn=-71
    are=101 are_=200 are_a=200 are_about=200 are_at=139 are_behind=-127 are_by=-168 are_done=4
    are_facing=-200 are_four=-93 are_given=197 are_in=-97 are_inside=-93 are_no=120 are_not=176
    are_now=-200 are_on=-163 are_out=161 are_some=-93 are_standing=-200 are_the=190 are_there=9
    are_told=200 are_two=-200 are_void=200 are_you=117 area=-200 area_=-163 area_and=-134
    area_then=-71 area_with=-147 aren't=45 arguments=172 arm=-41 arm's=-71 arm_=16 armchair=-170
    armchair_=-133 armchair_and=-93 armchair_then=-71 armchairs=-140 armchairs_and=-111
    armor=-152 armor_=-140 armour=-41 armrest=-71 arms=-181 arms_=-163 around=-131 around_=-87
    around_and=-38 around_go=-103 around_here=101 around_it=-83 around_its=-93 around_so=-181
    around_the=-200 around_then=-71 around_to=-200 around_until=-172 arr=-41 arrival=-41
    arrived=146 arrived_=200 arrow=-93 art=-127 artwork=-71 as=134 as_a=200 as_far=-200
    as_if=143 as_it=91 as_long=200 as_soon=-63 as_the=114 as_they=101 as_this=200 as_you=-109
    as_your=200 ascend=-111 ascended=-41 ascending=-41 aside=172 ask=139 asked=200 asks=200
    asks_that=200 asleep=45 assistant=200 assumed=172 at=-114 at_a=23 at_all=91 at_any=200
    at_each=200 at_every=200 at_it=-163 at_its=-200 at_my=117 at_once=200 at_that=-41
    at_the=-200 at_your=69 atm=-111 atm_=-93 atrium=-71 attempt=172 attention=71 attic=-124
    attic_=-16 attic_and=-103 attic_through=-57 aunt=86 aunt's=86 auntie=-41 auntie's=-41
    authorise=172 authorised=131 authority=172 automatic=-172 automatic_doors=-152 available=-41
    avoid=190 avoided=200 aw=-41 await=131 away=27 away_=53 away_from=5 awful=-41 awning=-111
    axis=102 axis_=122 axis_at=112 axle=-41 aystay=172 azimuth=-41 b=-50 b_and=-93 babe=-41
    babies=-71 baby=0 baby's=-41 baby_gate=-111 back=84 back's=-41 back_=200 back_and=142
    back_door=-200 back_from=-18 back_inside=-200 back_into=-140 back_is=101 back_of=-189
    back_on=-172 back_out=-200 back_past=-111 back_stairs=-93 back_through=101 back_to=134
    backpack=-41 backs=-71 backward=200 backward_wherever=112 backwards=161 bad=132 baddies=86
    bag=-93 baggage=-71 bakery=132 balcony=-200 balcony_=-200 balcony_and=-111 balcony_door=16
    bales=-71 ball=-111 balloon=-71 ballroom=-181 ballroom_=-93 balls=-111 balls_and=-93
    balusters=-41 balustrade=-71 bamboo=-71 bananas=-127 bananas_=-93 bandage=86 bang=-41
    banister=9 bank=-7 banquet=-71 baptismal=-71 baptistery=-111 bar=-200 bar_=-200 bar_and=-172
    bar_area=-163 bar_on=-111 bar_stool=-93 bar_stools=-200 bar_with=-111 barbecue=-163
    barbecue_=-93 barn=-172 barn_door=-111 barometer=-71 barracks=86 barrel=-181
    barrel_table=-111 barrels=-197 barrels_=-93 barrels_and=-152 barrier=-111 bars=-71
    barstool=-41 base=120 basement=45 basically=172 basket=-200 basket_=-152 basket_and=-111
    basketball=-71 baskets=-71 bath=-127 bathrobes=-41 bathroom=-133 bathroom_=-130
    bathroom_and=-200 bathroom_door=-111 bathroom_on=-158 bathroom_then=-140 bathroom_with=-111
    bathtub=-141 bathtub_=-200 bathtub_and=-71 battery=200 bay=-197 bay_window=-181 be=73
    be_a=-172 be_careful=-140 be_done=200 be_facing=-200 be_in=-187 be_next=-200 be_obeyed=200
    be_on=-200 be_the=-25 bead=-93 bead_curtain=-93 beaded=-93 beaded_curtain=-93 beam=-71
    bean=-71 beanbag=-66 beanbags=-71 beans=-41 bear=-92 bear_=-41 bear_left=-152
    bear_right=-200 bear_slightly=-93 bearing=-66 beautiful=-7 beauty=-71 because=-127
    because_the=-127 bed=-200 bed_=-200 bed_and=-200 bed_in=-93 bed_on=-197 bed_take=-82
    bed_to=-111 bed_turn=-71 bed_walk=-93 bed_with=-189 bedding=-41 bedroom=-62 bedroom_=36
    bedroom_and=-200 bedroom_at=-127 bedroom_go=101 bedroom_past=-93 bedroom_then=-57
    bedroom_with=-185 bedrooms=172 beds=-114 beds_=-197 beds_and=-140 beds_are=101 been=200
    been_cancelled=200 beers=-41 before=84 before_it=74 before_the=-47 before_we=16
    before_you=134 began=200 began_=200 begin=87 begin_=200 begin_by=-13 beginning=200
    beginning_=190 begins=200 begins_=174 begun=172 behalf=172 behave=172 behind=-200
    behind_it=-200 behind_the=-200 behind_you=-200 beige=-93 being=-93 believe=91 believes=86
    bell=-163 bell_=-93 bellhop's=-71 bells=86 below=200 below_is=200 belt=-93 bench=-200
    bench_=-200 bench_and=-200 bench_in=-103 bench_then=-71 benches=-140 benches_=-127 bend=-41
    bends=-111 beneath=-181 beneath_the=-127 berth=-41 beside=-90 beside_a=-93 beside_it=-140
    beside_the=-200 best=86 bestie=-41 bet=-41 better=123 between=-200 between_=-163
    between_the=-200 between_them=-200 between_two=-25 beyond=45 beyond_it=101 bicycle=-163
    bicycle_=-111 bicycles=-71 bidet=-111 bidet_and=-93 bifurcates=-41 big=-200 big_clock=-93
    big_desk=-111 big_glass=-111 big_window=-93 bigger=45 biggest=-93 bike=-200 bike_=-120
    bike_and=-103 bikes=-152 bikes_and=-93 billet=-41 billiard=-111 billiard_table=-111
    billiards=-71 bin=-111 bin_=-111 bird=91 birdbath=-140 birdbath_=-111 birdcage=-71 birds=-41
    birthday=86 biscuit=45 bisect=-41 bit=-5 bit_left=-93 bit_of=153 bit_to=-93 black=-198
    black_and=-127 black_door=-111 black_railing=-82 blackboard=-140 blackboard_=-111
    blanket=-140 blanket_=-111 blankie=-41 blast=-41 bleachers=-71 bless=45 blew=86 bliss=-41
    blocked=60 blocks=172 blood=-71 blotchy=86 blue=-176 blue_carpet=-127 blue_chairs=-93
    blue_door=16 blue_sofa=-82 blue_vase=16 blurs=172 board=17 board_=-200 board_with=-111
    boardroom=-71 boat=-71 body=-41 boiler=-189 boiler_=-152 bollard=-71 bones=-41 bong=-41
    book=101 bookcase=-198 bookcase_=-185 bookcase_and=-152 bookcase_then=-71 bookcases=-111
    bookcases_=-111 books=-111 bookshelf=-200 bookshelf_=-193 bookshelf_and=-82 bookshelves=-93
    boom=-41 boot=-93 booth=-200 booth_=-127 booth_and=-140 booths=-127 boots=-127 boots_and=-93
    borders=172 boring=86 boss=159 both=-183 both_flights=-140 both_sides=-140 bother=172
    bottles=-93 bottom=-200 bottom_=-200 bottom_and=-93 bottom_of=-200 bottom_turn=-152
    bottom_you'll=-93 bound=-93 bounds=153 bouquet=-71 bow=86 bowl=-49 bowl_=-25 bowl_of=-127
    bowling=-41 box=-54 box_=-111 boxes=60 boxes_=-93 boys=-41 branch=-71 brass=-152 bravo=45
    breach=-41 bread=-111 bread_and=-93 break=87 break_=200 break_room=-93 breakfast=-90
    breakfast_nook=-117 breaking=-41 breath=91 breathe=-41 breather=-41 breathtaking=-41
    breeze=-41 brick=-141 brick_steps=-93 brick_wall=-95 bricked=-41 bricks=-41 bridge=-54
    bridge_and=-93 bright=-111 bright_hallway=-93 bring=45 brings=-41 brochure=-111 broke=86
    broken=200 brolly=-41 bronze=-71 broom=-71 brother=171 brother's=91 brothers=-41 brown=-200
    brown_couch=4 brown_door=-111 brr=-41 brrr=-41 brushes=-41 bubbles=-41 bubbling=-41
    bucket=-172 bucket_=-93 buddha=-71 buddy=-93 buffer=172 buffet=-54 buffet_=-111 bugs=-41
    build=172 building=172 building_=200 built=200 bulb=-93 bulkhead=-41 bullet=-7 bulletin=-111
    bulletin_board=-111 bum=-71 bump=-140 bump_into=-111 bunch=-111 bunch_of=-93 bunk=-200
    bunk_=-111 bunk_beds=-200 bunker=86 bunks=-71 bursting=-41 bushes=-71 bust=-197 bust_=-163
    bust_on=-93 but=4 but_do=79 but_don't=-152 but_i=91 but_it's=21 but_no=16 but_not=-163
    but_only=-93 but_that's=91 but_turn=-111 but_we're=16 but_you=39 but_you're=91 butler's=-41
    butterfly=-41 buttons=45 buy=86 by=-73 by_=60 by_a=51 by_facing=-177 by_it=-152 by_order=200
    by_the=-135 by_walking=-17 by_way=-193 bypass=-41 c=-181 cabin=-130 cabin_and=-111
    cabin_door=-140 cabinet=-200 cabinet_=-200 cabinet_and=-177 cabinet_with=-111 cabinets=-147
    cabinets_=-111 cabins=-111 cables=-93 cables_=-93 cactus=-181 cactus_=-111 caf=-140
    cafe=-172 cafeteria=-41 cage=-93 cake=-140 cake_=-140 cakes=-41 calibration=172 call=101
    call_it=101 called=23 called_a=-140 calling=172 calm=86 calories=-41 came=13 camera=133
    camp=86 can=-33 can't=33 can't_go=-1 can_=-140 can_and=-57 can_go=-140 can_see=-105
    can_stop=-70 can_then=-127 can_you=93 cancel=200 cancel_the=200 cancelled=200 cancelled_=194
    cancelled_the=163 candle=-200 candle_holder=-172 candles=-189 candles_=-111 candles_and=-111
    candles_on=-93 candy=-93 cannon=-41 cannons=-41 cannot=-41 canopy=-111 cans=-71 canteen=86
    captain=194 captain's=-41 car=-103 car_and=-127 card=-71 cardies=-41 care=86 careful=-200
    carefully=-71 caretaker=172 carousel=-71 carpet=-200 carpet's=-41 carpet_=-200
    carpet_and=-103 carpet_on=-71 carpet_to=-158 carpeted=-140 carpets=-41 carriage=-41
    carried=200 carries=-41 carry=97 carry_on=-22 carry_out=200 carrying=-71 cars=-71 cart=-140
    carts=-152 carts_=-111 case=-83 case_=-177 case_on=-111 case_walk=-57 cases=-41 cash=-200
    cash_register=-189 casino=86 cask=-71 castle=45 castles=86 cat=45 cat's=45 catalog=-41
    catalogue=-41 catch=-41 cats=172 cause=-140 cease=172 ceiling=48 ceiling_=20 cellar=-200
    cellar_=-120 cellar_and=-93 cello=-71 center=-110 center_aisle=-111 center_with=16
    central=-41 centre=-41 cereal=-111 chains=-71 chair=-80 chair_=-166 chair_and=-181
    chair_by=-152 chair_is=101 chair_on=-158 chair_walk=-82 chair_with=-93 chairs=-104
    chairs_=-200 chairs_and=-200 chairs_on=-140 chairs_turn=-57 chalkboard=-41 chambers=-41
    champ=86 chance=131 chandelier=-180 chandelier's=-41 chandelier_=-200 chandelier_and=-147
    change=185 change_of=190 changed=200 changed_your=197 changes=-181 changes_from=-172
    changing=-172 changing_room=-111 changing_table=-111 chapel=-103 chapel_=-93 chapel_and=-7
    chapels=86 characters=-41 charge=200 charger=200 charging=9 charging_station=-163
    charlie=-71 charming=-41 chart=-140 chart_table=-111 chassis=-41 chat=131 chatting=-41
    check=-76 check_in=-111 checked=131 checkerboard=-41 checklist=-41 checkout=-93
    checkout_counter=-93 checkpoint=-41 cheerful=-71 cheers=79 cheery=-41 cheese=45 chess=-111
    chest=-152 chest_=-93 chest_of=-93 chick=-41 chief=200 chief_of=200 child=172 children=-71
    children's=-41 chill=-41 chimney=-93 china=-140 china_cabinet=-140 chinese=-140 chips=-41
    chocolate=-7 chocolate_fountain=-93 choices=-41 choo=45 choose=200 choose_the=161 chop=86
    chow=86 christmas=-25 christmas_tree=-25 chuck=-71 chum=-41 church=-20 church_and=-93
    chute=-71 cinderella=-41 cinema=86 circle=25 circle_and=200 circles=172 circular=-41
    circumference=-41 circumnavigate=-41 circumstances=200 clang=-41 clank=-41 clarity=86
    class=-93 classroom=-200 classroom_=-152 classroom_and=-111 clatter=86 clattering=-41
    claw=-41 clawed=-41 cleaner=-152 cleaner_=-93 clear=33 clear_the=-163 clearance=131
    cleared=86 clerestory=-41 clerk's=-71 clever=86 climb=-71 climb_=190 climb_down=-93
    climb_it=45 climb_the=-200 climb_to=-93 climb_up=-111 climbed=45 climbing=-25 climbs=172
    cloakroom=-66 cloakroom_=-93 clock=-194 clock_=-200 clock_and=-200 clock_go=-57 clock_on=-93
    clocks=-23 clockwise=-189 close=31 close_=-111 closed=77 closed_door=-111 closely=-41
    closes=-41 closest=-200 closest_to=-152 closet=-183 closet_=-200 closet_and=-28
    closet_on=-111 closet_then=-71 closet_with=-82 closing=-71 clothes=-146 clothing=-71
    clue=-41 cmd=172 coast=-140 coat=-200 coat_hooks=-200 coat_rack=-200 coat_room=-111
    coats=-66 coats_on=-93 coca=-140 cocoa=-41 code=101 coffee=-200 coffee_machine=-140
    coffee_maker=-111 coffee_table=-200 coffees=-41 cola=-152 cold=16 colonel=86 colonnade=-93
    colored=-93 colored_glass=-93 colorful=-71 colors=-41 coloured=-152 column=-197 column_=-93
    column_on=-71 columns=-172 comb=-41 combined=-41 come=-31 come_back=95 come_in=-111
    come_on=-111 come_out=-200 come_to=-156 comes=92 comfort=86 comfortably=86 comfy=31
    coming=91 command=200 commander's=86 commands=200 commands_as=200 commands_be=200
    comment=172 commode=45 companionway=-41 compass=-41 complaints=86 complete=200
    completely=-71 completing=172 completion=-41 compliance=172 computer=-200 computer_=-134
    computer_and=-147 computers=-127 concentrate=86 concern=101 concerned=86 concession=-41
    concierge=-111 concierge's=-71 concierge_desk=-93 concrete=-140 condition=190
    conditional=-41 conference=-200 conference_room=-200 conference_table=-111 confessional=-111
    confirm=-41 confuse=172 confuses=131 confusing=-41 consecutive=-41 conservatory=86
    consider=200 consider_the=190 consideration=-41 console=-127 console_table=-127 constant=-41
    constraint=-71 cont'd=-41 contact=-111 contact_=-93 contains=-41 content=172 continue=-23
    continue_down=-147 continue_on=-140 continue_past=45 continue_to=-200 continue_until=-1
    continuous=172 contrary=200 contrary_of=176 control=100 control_room=100 conveyor=-71
    cooee=86 cookies=86 cooking=172 cooler=-200 cooler_=-193 cooler_and=-127 coordinates=-41
    copier=-200 copier_=-127 copper=-71 copy=21 copy_machine=-93 corkscrew=-41 corner=-111
    corner_=-200 corner_and=-93 corner_to=-111 correct=131 correction=200 corridor=-200
    corridor_=-189 corridor_and=-120 corridor_past=-140 corridor_to=-93 costumes=-111 cot=-71
    cots=-93 cotton=86 couch=20 couch_=16 couch_and=-58 couch_on=-93 couch_turn=-103
    couches=-200 couches_and=-93 could=8 could_you=21 couldn't=-41 council=172 count=79
    count_the=-111 counted=-41 counter=-200 counter_=-200 counter_and=-200 counter_clockwise=-93
    counter_turn=-71 counting=-41 country=-41 counts=200 couple=-197 couple_of=-197 course=-93
    court=86 courtyard=-172 courtyard_and=-93 cousin=86 cousin's=16 cover=-93 covered=-41
    covers=86 cowboy=-71 cozy=-93 cr=-140 crate=-71 crates=86 crayons=-41 cream=-111 creep=172
    crest=-41 crib=-200 crib_=-181 crib_and=-111 crib_go=-93 cribs=-41 cried=45 crikey=86
    crisps=86 croissants=86 cross=-161 cross_on=-140 cross_over=-189 cross_the=-200 cross_to=-93
    crossed=-41 crosses=-41 crossing=101 crossword=86 crying=45 crypt=-41 crystal=-93
    crystals=-41 cubbies=16 cubicle=-127 cubicles=-111 cuckoo=86 cue=-41 cues=-41 cup=-41
    cupboard=-200 cupboard_=-111 cupboards=-41 cuppa=-41 cups=45 curl=-41 curlers=-41
    currency=-71 current=200 currently=-41 curry=86 curtain=-200 curtain_=-200 curtain_and=-200
    curtained=-71 curtains=-127 curtsy=-41 curved=-172 curved_stairs=-152 curves=-93 curving=-41
    curvy=-41 cushion=-197 cushion_=-181 cushions=-71 custard=86 cut=161 cute=-93 cutest=-41
    cutter=-71 cylinder=-41 cylinders=-71 d=31 da=-71 dad=131 daddy=-41 daddy's=45 daft=-41
    damage=172 dance=-54 dance_floor=-127 dancer=172 dancing=-41 danger=-140 dark=-49
    darkroom=-41 darling=45 dartboard=-163 dartboard_=-152 date=200 date_=200 datum=86 dave=86
    davenport=16 dawdle=-93 day=198 day_=166 daylight=-41 days=86 dead=-25 dead_ahead=-93
    dear=-71 decided=172 decimetre=-41 decision=172 deck=-82 deck_=-22 deck_with=-93 decking=-41
    declare=172 decode=172 deep=21 deer=-111 deer_head=-111 defined=-41 definition=-41
    degree=-93 degrees=-200 degrees_=-181 degrees_and=-127 degrees_left=-111 degrees_right=-152
    degrees_so=-93 degrees_to=-189 delete=200 delivers=-41 delta=-71 demo=-140 demonstration=86
    den=-181 den_=-120 den_and=-71 denied=172 dentist's=-41 dentists=86 depart=-71 department=16
    department_=16 descend=-44 descend_the=-197 descending=-71 descends=-41 describe=172
    described=200 described_=200 description=200 design=-41 desk=-200 desk_=-200 desk_and=-200
    desk_on=-140 desk_the=-172 desk_to=-103 desk_turn=-93 desk_walk=-103 desk_with=-200
    desks=-127 desks_=-7 desks_and=-127 destination=129 detailed=-41 details=86 detect=-41
    detective=-41 determine=-41 developer=200 developer's=-140 deviate=-41 deviation=-41
    dexter=-41 di=-41 diagonally=-152 diagonally_to=-93 diametrically=-41 dictionary=-71 did=200
    did_last=200 different=153 ding=-71 dingy=-41 dining=-200 dining_room=-200 dining_table=-200
    dinosaur=-66 dinosaur_skeleton=-93 direction=69 direction_of=-1 direction_you=197
    directional=172 directions=200 directions_=200 directions_are=200 directions_that=163
    directly=-152 directly_beneath=-93 director=172 dirty=45 disabled=172 discard=86 disco=-71
    dishwasher=-200 dishwasher_=-140 dishwasher_and=-103 displacement=-41 display=-200
    display_case=-172 disregard=200 disregard_all=176 disregard_the=156 distance=59
    distance_to=-163 distances=172 diving=-71 dizzy=-41 dj=-71 do=158 do_=200 do_any=200
    do_is=-25 do_it=200 do_me=-93 do_not=154 do_nothing=129 do_only=200 do_that=-93 do_the=200
    do_what=200 do_you=60 dock=200 doctor=172 doctor's=31 document=200 does=139 does_not=200
    doesn't=-71 dog=-117 dog's=-41 dog_bed=-93 dogleg=-41 doing=200 dokey=-41 doll=-41 dolls=-93
    don't=-9 don't_climb=-111 don't_enter=-140 don't_go=-70 don't_have=-7 don't_need=-93
    don't_stop=-1 don't_take=-9 don't_turn=-163 don't_worry=16 done=136 done_=200 done_once=-82
    done_when=-197 dong=-41 donkey=86 donotfollowtheroute=172 dont=172 dooor=172 door=-118
    door's=-41 door_=-150 door_a=-93 door_and=-166 door_at=-152 door_b=-93 door_behind=-172
    door_but=16 door_by=-93 door_go=25 door_in=-200 door_into=-140 door_is=59 door_left=-93
    door_near=-111 door_next=-163 door_not=-152 door_of=-163 door_on=-200 door_opposite=-163
    door_says=91 door_stop=-111 door_that=43 door_that's=-181 door_the=-200 door_then=-200
    door_there=-163 door_to=-168 door_turn=38 door_with=-200 door_without=-93 door_you=22
    doormat=-172 doormat_=-163 doors=-176 doors_=-167 doors_and=-200 doors_are=-93 doors_at=-93
    doors_go=-147 doors_on=-146 doors_one=-93 doors_that=101 doors_then=-177 doors_with=-93
    doorway=-155 doorway_=-49 doorway_and=-177 doorway_of=-200 doorway_on=-168 doorway_then=-57
    doorway_to=-152 doorway_walk=-18 doorway_with=-127 doorways=-41 double=-34 double_doors=-200
    doubling=-41 doubt=172 down=-92 down_=33 down_a=-127 down_and=200 down_five=-152
    down_into=-111 down_it=-181 down_on=101 down_one=-200 down_the=-200 down_them=-181
    down_three=-172 down_to=-53 down_two=-163 down_until=-93 downstairs=-111 downwards=-41 dr=31
    drafting=-93 drafting_table=-93 drain=-71 draw=132 drawbridge=-71 drawers=-152 drawers_=-111
    drawing=-71 drawings=86 drawn=-41 dreadful=-41 dream=86 dreamy=-41 drenched=-41 dresser=-200
    dresser_=-103 dresser_and=-82 dresser_on=-57 dresser_then=-168 dresses=-71 dressing=-200
    dressing_room=-197 dried=-71 drifting=-41 drill=101 drink=-41 drinking=-140
    drinking_fountain=-140 drinks=-71 drip=-41 drive=151 driver=86 drives=-41 drop=200
    drop_this=132 dropped=86 drown=-41 drum=-189 drum_kit=-163 drums=-140 drums_=-93 dryer=-200
    dryer_=-181 dryers=-71 drying=-41 duck=16 ducts=-41 ductwork=-41 dumbbells=-71 dumpling=-41
    dumpster=-71 dumpsters=-71 dungeon=-41 during=172 duties=172 duty=-41 e=-197 each=200
    each_direction=200 each_doorway=176 each_minute=176 each_other=-140 each_step=175
    each_time=200 each_turn=200 earlier=200 early=86 earrings=86 ears=16 ears_=16 ease=86
    easel=-163 easel_=-93 easel_and=-127 easiest=-41 east=132 easy=-8 eat=-71 eaten=86
    eating=-41 echo=86 echoey=86 edge=-200 edge_=-111 edge_of=-200 edges=-71 effect=190 eggs=-71
    egress=-41 egyptian=-41 eight=101 eighth=-71 either=-152 element=-41 elephant=-71
    elevation=-41 elevator=-200 elevator_=-172 elevator_and=-189 elevator_doors=-111
    elevator_lobby=-111 elevators=-189 elevators_=-152 eleven=-71 else=177 emergency=60 emit=200
    empty=-41 end=-37 end_=-180 end_and=-44 end_at=-163 end_go=-111 end_of=-108 end_so=101
    end_the=200 end_this=197 end_turn=-140 end_up=53 end_you'll=-93 endlessly=172 ends=-57
    ends_=-181 ends_at=-172 energy=172 engine=-111 engine_room=-111 engineer=172 engineers=172
    engines=172 enjoy=-41 enjoying=-41 enough=161 enter=-62 enter_=-200 enter_a=190 enter_and=45
    enter_it=-93 enter_the=-141 enter_through=-181 entering=-163 entering_any=-93
    entertainment=-71 entrance=-135 entrance_=16 entrance_and=-93 entrance_to=-111 entry=-140
    entryway=-193 entryway_=-111 entryway_and=-71 environment=-41 episode=200 episodes=172
    equipment=-71 erase=172 erehay=172 errand=172 error=200 error_=200 escalator=-200
    escalator_=-181 escalator_up=-93 escalators=-41 espresso=-71 essential=200
    essential_that=200 establishing=86 ethay=172 ethics=172 evacuation=-140 even=60 event=-71
    ever=200 every=200 every_door=79 every_few=149 every_instruction=200 every_landmark=200
    every_order=176 every_time=112 every_turn=200 everybody=101 everyone=137 everything=155
    everywhere=123 everywhere_=153 eway=172 ex=-41 exactly=190 exam=-93 exceed=172 except=174
    exception=172 exchange=101 exchanged=200 exclude=-41 excluded=-41 excuse=132 execute=79
    executed=172 executing=200 execution=-41 exercise=-103 exercise_bike=-152 exit=-200
    exit's=-41 exit_=-197 exit_and=20 exit_sign=-200 exit_the=-200 exit_through=-163 exits=-41
    expanded=-41 explain=132 exploring=194 exposed=-41 extinguisher=-200 extinguisher_and=-163
    extract=-41 ey=-41 eye=-111 eyepiece=-41 eyes=-93 f=-41 fab=86 face=-53 face_=-93
    face_away=-111 face_the=-60 facing=-200 facing_a=-200 facing_it=-93 facing_the=-200 fact=86
    factory=86 failed=86 failure=172 fake=-41 fall=-163 falling=-41 falls=86 family=-158
    family_room=-147 fan=-25 fancy=45 far=-188 far_=-95 far_as=-200 far_corner=-163
    far_door=-127 far_end=-200 far_left=-140 far_side=-152 far_wall=-197 farther=-93
    farthest=-93 fast=-41 faster=-41 faucet=86 fault=172 favor=-41 favour=-41 feel=116
    feeling=86 feet=-72 feet_=-93 feet_from=-163 feet_to=-134 fell=132 fella=86 fella's=-41
    fellow=-41 fence=-127 fence_=-127 fern=-172 fern_=-163 fetched=-41 fetches=172 few=57
    few_feet=-134 few_steps=37 fgbc=172 ficus=-71 fiddling=-41 field=-41 fifteen=-41 fifth=-127
    fig=-71 figures=86 file=-71 filing=-152 filing_cabinet=-127 fill=-41 filled=-41 fills=-41
    film=-71 final=-7 finally=45 find=-200 find_a=-200 find_it=-181 find_me=-111 find_the=-200
    find_yourself=-93 fine=82 finish=150 finished=158 finished_=161 fire=-34
    fire_extinguisher=-200 fire_hose=-111 fireplace=-200 fireplace_=-200 fireplace_and=-200
    fireplace_then=-82 fireplace_to=-82 fires=-41 firewood=-71 first=-19 first_=175
    first_and=-152 first_bar=-93 first_door=-129 first_is=-93 first_landing=-200 first_left=-111
    first_of=8 first_opening=-140 first_right=-152 first_room=54 first_row=-93 first_seat=-111
    first_step=59 first_table=-111 first_two=-189 first_window=-111 first_you=-111 firstly=-41
    fish=-200 fish_tank=-200 fit=86 fits=86 fitting=-111 fitting_room=-93 five=-37 five_=-93
    five_steps=-177 fixed=172 fixtures=-41 flag=-93 flagpole=86 flags=-140 flank=-41 flap=-93
    flat=39 flew=86 flies=86 flight=-164 flight_=-93 flight_of=-200 flights=-200 flights_of=-189
    flip=200 flipped=172 float=-71 floor=-37 floor_=-111 floor_and=-1 floor_changes=-163
    floor_go=-93 floor_in=101 floor_is=190 floor_lamp=-140 floorboard=-71 floors=-152
    floors_=-93 flop=-71 florist=-41 flower=-172 flower_shop=-93 flower_stand=-111 flowers=-181
    flowers_=-111 flowers_on=-93 flue=86 fluffy=-93 fold=-71 folding=-93 follow=-44 follow_=149
    follow_it=-200 follow_so=112 follow_the=-116 followed=131 following=164 following_steps=200
    following_the=45 follows=200 follows_=200 font=-172 font_=-111 font_and=-93 food=-71
    foosball=-140 foosball_table=-140 foot=-200 foot_of=-200 footstool=-71 for=120 for_a=-11
    for_all=200 for_another=190 for_it=101 for_me=-19 for_right=200 for_the=77 for_this=117
    for_today=200 for_you=129 for_your=139 forbid=172 forbidden=172 forbids=200 forbids_you=200
    forget=200 forget_all=200 forget_the=63 forgetting=-41 forgot=-111 forgotten=172 fork=-172
    forks=-41 form=-71 forth=-41 forward=-121 forward_=-124 forward_and=-140
    forward_between=-111 forward_down=-93 forward_past=-181 forward_to=-140 forward_two=-93
    forwards=-41 found=200 found_it=200 fountain=-200 fountain_=-200 fountain_and=-93 four=-133
    four_step=-57 four_steps=-163 four_windows=-111 fourteen=-71 fourth=-38 fourth_door=9
    foxtrot=-71 foyer=-118 foyer_=-68 foyer_and=-93 foyer_with=-82 frame=-111 framed=-111
    free=-7 freedom=-41 freely=172 freeze=131 freezer=-189 freezer_=-172 french=-200
    french_doors=-200 freshen=-41 fresher=-41 fridge=-192 fridge_=-200 fridge_and=-107
    fridge_then=-103 friend=71 friend's=86 friend_=94 friend_and=-93 friendly=-7 from=57
    from_here=20 from_it=106 from_now=200 from_the=-16 from_there=-197 from_where=101
    from_you=122 from_your=190 front=-146 front_=60 front_desk=-172 front_door=-81 front_of=-178
    front_pew=-93 frosted=-71 froze=86 frozen=131 fruit=-7 fruit_bowl=16 ft=-140 full=20
    full_access=176 full_length=-93 full_of=-31 fully=-41 fun=60 function=-71 functional=-41
    funnily=-41 funny=86 furnace=-71 furniture=190 further=200 further_=105 fuse=62 fuse_box=16
    fuss=-41 future=172 fyi=86 gabbing=86 gallery=-86 gallery_=-93 gallery_and=-111 galley=-93
    game=-86 game_room=-163 gangway=-71 gap=-200 gap_between=-93 garage=-70 garage_=-6
    garage_by=-71 garage_go=-82 garden=2 garden_=31 gardening=-41 gas=-111 gate=-200 gate_=-200
    gate_and=-93 gate_in=-111 gave=200 gawp=-41 gazebo=-71 gears=172 geese=-41 general=200
    generator=-111 generator_=-111 generous=172 gentle=-71 gentlemen=86 gently=-71 get=-151
    get_a=16 get_in=-111 get_off=-93 get_out=-200 get_there=-1 get_to=-200 get_you=-25 gets=-41
    getting=-71 giant=-140 gift=-181 gift_shop=-181 give=-1 give_it=-93 given=200 given_=200
    gives=198 giving=-41 glamorous=-41 glance=86 glass=-172 glass_=31 glass_and=-111
    glass_case=-93 glass_door=-200 glass_doors=-200 glass_table=-200 glass_walls=-111
    glass_window=-111 glasses=-127 glasses_=-93 glazed=-71 glazing=-41 globe=-200 globe_=-181
    globe_and=-127 globes=-71 glove=86 glowing=-71 glug=-41 go=-108 go_=92 go_across=-111
    go_ahead=-140 go_all=-200 go_along=-200 go_and=-163 go_any=45 go_anywhere=200 go_around=-200
    go_back=179 go_backward=200 go_behind=-163 go_between=-200 go_by=-200 go_down=-200
    go_forward=-43 go_from=-172 go_halfway=-93 go_home=200 go_in=-101 go_inside=-111
    go_into=-115 go_left=-87 go_on=33 go_out=-200 go_outside=-200 go_over=-93 go_past=-200
    go_right=-73 go_round=-61 go_slightly=-127 go_straight=-200 go_the=161 go_there=45
    go_through=-184 go_to=-115 go_toward=-200 go_towards=-189 go_under=-200 go_up=-177 goal=200
    goal_=200 goal_is=105 goals=172 goat=163 goes=69 goes_to=-111 going=-66 going_down=-66
    going_in=-54 going_left=-93 going_past=-127 going_straight=-177 going_through=-127
    going_to=24 going_until=-200 going_up=-163 gold=-200 golden=-93 gone=-16 gone_past=-93
    good=183 good_=185 good_morning=163 goodbye=172 goodies=-41 gorgeous=-111 gosh=86 gossip=86
    got=9 got_a=65 got_the=91 got_to=-93 gowns=-41 grab=-41 gradient=-41 gramophone=-71
    gramophone's=-41 gran's=-41 grand=45 grandad's=-41 grandfather=-200 grandfather_clock=-200
    grandma's=86 grandmother=86 grandpa's=86 granny=132 granny's=86 grass=-140 grate=-41
    grating=-41 graveyard=-71 gray=-200 great=79 green=-184 green_=-140 green_armchair=16
    green_chair=-111 green_chairs=-111 green_door=-41 greenhouse=45 greeted=-71 grew=86
    grey=-200 grey_couch=-82 grid=86 grill=-200 grill_=-200 ground=-7 ground_floor=-7 grown=-111
    guard=200 guard's=-163 guard's_chair=-163 guardrail=-41 guardroom=86 guess=70 guess_what=91
    guest=22 guest_room=-197 guests=172 guidance=172 guitar=-111 gumball=-111
    gumball_machine=-111 gun=-140 gunner's=86 gym=-90 gym_=16 gym_and=-120 gym_with=-93
    gymnasium=-93 ha=16 had=157 had_a=200 haha=45 hair=-127 half=27 half_landing=-93 half_of=200
    half_right=-93 halfway=-200 hall=-188 hall's=-41 hall_=-200 hall_and=-121 hall_by=-127
    hall_door=16 hall_into=-140 hall_of=-111 hall_then=-158 hall_through=-93 hall_turn=-82
    hall_with=-163 hallway=-176 hallway_=-171 hallway_and=-200 hallway_as=-93 hallway_in=-93
    hallway_on=-189 hallway_past=-200 hallway_splits=-172 hallway_then=-127 hallway_to=-172
    hallway_turn=-120 hallway_with=-200 hallways=-93 hallyway=-140 halt=48 halt_=69 halt_at=-15
    halt_by=-93 hammock=-127 hammock's=-41 hamper=-140 hamper_and=-93 hamster=-71 hand=52
    hand's=172 hand_=79 hand_door=-140 hand_for=200 hand_side=-197 handedness=172 handles=-71
    handrail=-140 hands=186 handy=86 hang=-164 hang_a=-200 hangar=86 hanging=-200
    hanging_on=-140 hangs=-86 hansen=172 happens=172 happy=-140 hard=-200 hard_left=-163
    hard_right=-93 hard_to=-111 hardwood=-71 harp=-110 harp_=-93 harp_and=-127 harpsichord=-111
    harpsichord_=-111 has=187 has_a=-104 has_been=200 has_cancelled=163 has_changed=200
    has_closed=200 has_no=123 has_to=200 has_withdrawn=132 hat=-189 hat_=-93 hat_stand=-111
    hatch=-117 hatch_=-181 hats=-41 have=152 have_a=60 have_arrived=115 have_been=200
    have_found=190 have_gone=20 have_reached=105 have_the=200 have_to=68 have_you=171 having=70
    hay=-140 he=88 he's=122 head=-15 head_down=-127 head_for=-152 head_of=190 head_office=200
    head_on=-93 head_out=-152 head_straight=-93 head_through=-93 head_to=-200 head_towards=-185
    heading=-200 heading_you=-93 headmaster's=86 headquarters=194 headroom=-41 heads=-41
    health=172 hear=200 heard=200 heart=-41 hearth=-71 heated=-41 heater=-127 heater_=-93
    heave=-41 heavy=-163 hedge=-111 heed=172 height=-71 helical=-41 hello=170 hello_=91 help=16
    helps=-71 hence=16 henhouse=86 her=111 here=145 here's=-7 here_=121 here_and=200 here_is=100
    hereby=200 herein=172 hero=86 hex=172 hey=154 hi=141 hi_=91 hi_to=16 hidden=-71 hide=86
    hiding=-41 high=-135 high_chair=-54 high_chairs=-93 higher=45 highest=-71 hill=-41 him=-117
    him_=-189 hint=-41 his=-54 hit=60 hit_the=-111 hiya=86 hm=-41 hold=1 hold_=60 hold_at=-197
    hold_by=-111 hold_on=-200 hold_position=79 holder=-172 holder_=-82 holder_and=-103
    holding=-41 holds=-41 hole=-93 holes=86 home=200 home_=200 hon=-41 honestly=132 honey=86
    hook=-127 hooks=-200 hooks_=-200 hooks_and=-111 hoop=-71 hooray=-41 hoover=-93 hop=79
    hope=45 hopeless=86 horizontal=101 horse=-200 horse's=-41 horse_=-181 horses=-41 hose=-140
    hose_=-127 hospital=5 hospital_bed=-181 hot=-166 hot_tub=-200 hotel=-18 hour=200 hours=172
    house=88 house_=93 house_and=153 houses=-41 hover=-41 how=23 how's=187 how's_the=187
    how_to=-93 huge=5 human=172 hun=-41 hundred=86 hung=45 hungry=45 hunt=91 hurry=-189
    husband=-41 hut=-71 i=114 i'd=195 i'd_like=153 i'll=126 i'll_be=91 i'm=87 i've=54
    i've_got=-41 i_am=200 i_can=163 i_can't=157 i_don't=-7 i_e=-189 i_got=93 i_had=62 i_have=200
    i_know=47 i_left=-140 i_mean=-200 i_need=87 i_said=82 i_say=69 i_tell=200 i_want=-84
    i_was=199 ice=-200 ice_cream=-111 ice_machine=-200 idea=-71 identical=-41 idle=-41 if=80
    if_i=153 if_it=45 if_the=-140 if_they=200 if_you=40 if_you're=-93 ignore=128 ignore_the=90
    ignored=-41 ignorethenextstep=172 ignoring=131 ii=-93 iii=-71 ikea=-140 illuminated=-41
    image=172 imagine=141 immaterial=-41 immediate=200 immediately=16 immediately_=101
    immediately_and=101 important=172 in=-16 in_=-64 in_a=-50 in_all=198 in_an=-140 in_and=-200
    in_at=-163 in_between=-200 in_by=-93 in_charge=200 in_closet=-152 in_front=-176 in_go=161
    in_here=16 in_it=-50 in_my=91 in_order=16 in_our=163 in_place=200 in_reverse=200 in_that=60
    in_the=-68 in_there=-92 in_this=200 in_through=-189 in_turn=9 in_you=101 in_your=200
    inch=172 inclination=-41 increased=172 indefinitely=172 indications=172 indoor=-71
    indoors=-41 infiltrate=-41 information=-111 ingress=-41 initial=101 injured=172 inn=86
    inner=-93 innocent=-41 input=86 inside=-200 inside_=-200 inside_and=-185 inside_it=-93
    inside_the=-200 inside_then=-71 inside_through=-158 insists=-41 inspector=172 inspectors=172
    instance=-41 instead=123 instead_=200 instead_of=59 instruction=200 instruction_=200
    instructions=166 instrument=-41 intent=86 interchanged=172 intermediate=-41 internal=-41
    interpret=200 intersection=-71 intersects=-41 intervening=-41 interviews=86 into=-156
    into_a=-48 into_it=-127 into_the=-200 invert=172 inverted=200 inviting=-41 iron=-197
    iron_door=-140 iron_gate=-93 ironing=-189 ironing_board=-189 is=104 is_=71 is_a=16 is_an=45
    is_and=-93 is_at=-1 is_behind=-86 is_called=60 is_cancelled=91 is_closed=106
    is_essential=200 is_in=9 is_just=-93 is_left=-7 is_named=200 is_next=-172 is_no=200
    is_not=200 is_nothing=82 is_off=190 is_on=-62 is_only=91 is_open=31 is_out=190 is_right=161
    is_the=-37 is_to=181 is_void=200 is_what=153 is_where=-151 is_written=200 is_wrong=200
    is_your=60 is_yours=-93 island=-200 island_=-134 island_and=-134 island_on=-120 isn't=116
    isn't_it=153 issue=200 issued=200 it=31 it'll=60 it's=-5 it's_a=24 it's_dark=-93 it's_for=16
    it's_got=-41 it's_just=-7 it's_left=-7 it's_like=21 it's_not=-7 it's_the=-135 it_=7
    it_a=-111 it_and=-134 it_by=-93 it_curves=-93 it_down=-93 it_ends=31 it_go=-111 it_goes=-7
    it_has=63 it_in=101 it_into=-93 it_is=78 it_looks=-76 it_on=-200 it_right=79 it_says=200
    it_stop=-93 it_tells=112 it_the=174 it_then=-93 it_there's=-111 it_through=-140 it_to=-72
    it_turn=-127 it_until=-111 it_was=200 it_with=60 it_you=-93 it_you'll=-93 item=-41
    itinerary=172 its=-43 its_end=-200 its_far=-172 its_left=-181 its_near=-93 its_right=-200
    its_tail=-93 itself=-93 iv=-127 jackets=-140 jackets_=-111 jacuzzi=-158 jacuzzi_and=-93
    jacuzzis=-23 jeez=86 jelly=86 jigsaws=-41 job=123 job_=200 job_is=79 jog=-41 join=86
    joke=172 journey=101 journey_ends=101 judge's=-41 jug=-71 juice=-93 jukebox=-152
    jukebox_=-111 juliet=86 jump=-41 jumper=86 junction=79 just=-29 just_a=-86 just_after=-93
    just_before=-200 just_go=-65 just_inside=-200 just_like=91 just_outside=-177 just_past=-93
    just_stop=-127 just_to=-93 just_turn=-93 just_walk=-111 k=-71 karaoke=86 karate=86 keep=-31
    keep_going=-136 keep_on=-189 keep_out=79 keep_right=-93 keep_the=-200 keep_to=-200
    keep_turning=200 keep_walking=-50 keeper=86 keeping=-200 keeping_it=-181 keeping_the=-140
    keeping_them=-93 keeping_to=-127 keeps=-7 kept=16 kettle=-41 kevin=-41 key=-41 keyboard=-25
    keypad=-71 keys=-152 kick=-41 kiddies=-41 kidding=131 kids=-41 kill=-140 killing=-71
    kiln=-71 kilo=86 kind=67 kind_of=-93 kindly=200 kindness=-41 king=-71 king's=-41 kiosk=-71
    kit=-200 kit_=-172 kitchen=-79 kitchen_=-114 kitchen_and=-10 kitchen_door=79
    kitchen_doorway=-93 kitchen_is=-140 kitchen_island=-200 kitchen_now=-140 kitchen_past=-93
    kitchen_sink=-111 kitchen_through=-134 kitchen_with=-93 kitchen_you=-189 kitchenette=-25
    knee=45 knees=-41 knife=-71 knight=-41 knitted=86 knob=-71 knock=16 knocker=-71 know=99
    know_=91 know_it's=16 know_that=82 know_what=122 knows=194 l=-124 l_=-163 la=-41 lab=-111
    label=200 labelled=-140 lad=-41 ladder=-200 ladder_=-189 ladder_and=-200 ladder_on=-111
    ladder_to=-93 ladies=-41 lady=-93 lady's=-41 lake=86 lamp=-200 lamp_=-200 lamp_and=-200
    lamp_on=-163 lamps=-197 landing=-200 landing_=-190 landing_and=-181 landing_turn=-152
    landings=-41 landlord=172 landmark=200 landmark_is=190 landmarks=-41 landscape=-71 lane=-41
    lantern=-71 lap=-111 large=-200 largest=-41 laser=86 last=69 last_=200 last_door=-103
    last_every=112 last_one=-44 last_step=105 last_stool=-111 last_thing=-189 last_year=163
    lasts=200 lasts_=163 late=132 later=194 lateral=131 lathe=-71 latin=-41 laugh=194
    laughing=86 laundry=-200 laundry_basket=-172 laundry_room=-200 lava=-71 law=172 lawful=172
    lawn=-71 lawyers=172 layman=-41 lead=43 leading=-111 leads=-127 leaf=-41 leaning=-71
    learn=45 least=172 leather=-200 leather_chair=-82 leather_couch=-93 leave=-11 leave_=79
    leave_by=-197 leave_it=101 leave_the=-76 leave_this=106 leave_through=-181 leaves=-71
    leaving=-200 leaving_the=-200 left=-136 left_=-147 left_90=-140 left_across=-93
    left_after=-200 left_again=-193 left_along=-111 left_and=-159 left_around=-197 left_as=-54
    left_at=-200 left_before=-127 left_by=-54 left_corner=-140 left_down=-140 left_enter=-134
    left_for=93 left_go=-200 left_halfway=-93 left_hall=-93 left_hand=5 left_in=-197
    left_into=-121 left_is=137 left_just=-93 left_left=16 left_my=-152 left_not=-111 left_of=-86
    left_one=-181 left_out=45 left_pass=-93 left_past=-193 left_side=-200 left_so=-54
    left_staircase=-93 left_the=-152 left_then=-200 left_there=-200 left_through=-197
    left_to=-48 left_towards=-111 left_turn=74 left_until=-152 left_up=-93 left_walk=-111
    left_wall=-127 left_when=79 left_where=-127 left_which=16 left_with=45 leftmost=-111
    lefts=-41 leftward=-41 leg=-110 legend=-41 lego=-140 legs=62 legs_=91 leisurely=-41
    lemon=-71 length=-189 length_of=-127 lent=-41 less=-41 let=119 let's=-7 let's_get=-140
    let's_go=122 let's_start=-111 letter=151 letters=-140 level=-127 librarian=-41 library=-112
    library_=-140 library_and=-111 lie=-71 lied=172 lies=172 lieu=-41 life=69 life_jackets=-140
    lifeboat=-111 lifeboat_=-93 lifeboats=-111 lifebuoy=-111 lifebuoy_=-111 lifeguard=-93
    lifeguard's=-41 lift=-2 lift_=-25 lifts=-41 light=-189 lighted=-41 lighthouse=-71 lights=-93
    like=49 like_a=92 like_the=-76 like_you're=-172 limb=-41 limit=-41 limits=131 line=-114
    line_on=-152 lined=-41 linen=-200 linen_closet=-189 linen_cupboard=-93 lines=-152 lintel=-41
    lion=-140 lions=16 list=200 listen=-7 lit=-93 literally=-71 little=-128 little_=-163
    little_and=-140 little_bit=-93 little_hallway=-93 little_table=-93 lives=86 living=-44
    living_room=-59 lizard=86 load=-41 loading=-71 lobby=-200 lobby's=-41 lobby_=-200
    lobby_and=-200 lobby_to=-93 lobby_with=-93 lobster=86 locate=-197 locate_a=-140
    locate_the=-93 location=131 locked=133 locker=-93 locker_room=-93 lockers=-200 lockers_=-197
    lockers_and=-152 locomotion=172 loft=-103 loft_=-152 login=-140 lol=172 long=-51 long_as=200
    long_hallway=-111 long_part=-93 long_table=-82 long_wooden=-93 longer=200 loo=16 loo's=-41
    look=-72 look_at=49 look_down=-93 look_for=-144 look_to=-93 looking=64 looking_at=-189
    looking_for=161 looks=15 looks_like=69 loom=-71 loop=172 loose=-41 lose=-41 lost=95 lot=-76
    lot_of=-127 lots=-152 lots_of=-152 loud=45 loudspeakers=-41 lounge=-200 lounge_=-127
    lounge_and=-127 lounge_chairs=-127 lounge_go=-57 lounger=-71 loungers=-127 loungers_=-93
    love=94 lovely=-172 loves=-41 low=151 lower=-111 lowest=-41 luck=45 lucky=-41 luggage=-111
    lunch=-111 lying=194 m=-200 m_=-172 m_and=-93 machine=-200 machine's=-41 machine_=-200
    machine_and=-200 machine_on=-140 machine_then=-120 machine_with=-93 machines=-193
    machines_=-127 made=41 made_it=153 made_of=-163 made_out=-93 magazine=-71 magazines=-111
    magazines_=-93 magnificent=-41 magnitude=-41 mail=86 mailbox=-163 mailbox_=-127
    mailboxes=-181 main=-140 maintain=-41 majesty=-41 make=-164 make_a=-200 make_for=-163
    make_your=-200 maker=45 makers=172 makes=-54 makeup=-93 making=-7 man=92 management=200
    manager=200 manager's=-111 mannequin=-140 mannequin_=-93 mannequins=-71 manoeuvre=172
    mantelpiece=-41 manufacturer=200 many=-7 map=143 map's=-41 map_=-152 maps=86 marble=-200
    marble_bust=-111 marble_stairs=-111 marble_statue=-111 march=-71 margin=172 mark=-93
    marked=-163 market=-41 marquee=-41 married=-41 marshal=200 marta=172 masks=-71 massage=-117
    massage_room=-111 massage_table=-152 massages=-41 massive=-41 master=-152
    master_bedroom=-152 mat=-180 mat_=-200 match=86 mate=16 mats=-71 matter=200 may=200
    maybe=-41 maze=86 me=102 me_=88 me_a=-66 me_to=200 mean=-10 mean_the=-25 meaning=-71
    means=129 meant=88 measure=172 measured=86 measuring=-41 meet=131 meeting=-163 meetings=-41
    memo=86 memory=200 mended=86 mention=172 mentioned=200 mentioned_=200 mere=-41 mess=-127
    message=200 message_from=200 metal=-200 metal_stairs=-163 meteor=-41 meteorite=-93
    meter=-111 meters=-200 meters_=-111 meters_and=-140 metre=-41 metres=176 mezzanine=-71
    microfilm=-71 microphone=-71 microwave=-200 microwave_=-185 microwave_and=-82 microwaves=-23
    middle=-143 middle_=-111 middle_aisle=-111 middle_and=-93 middle_between=-111 middle_of=-58
    middle_one=-111 midpoint=-41 might=-66 milk=-93 miller's=-140 million=45 mind=118 mind_=123
    mind_the=20 mine=16 mine's=45 minerals=-71 mini=-71 minimise=-41 minimum=-41 ministry=172
    mint=-41 minus=-71 minute=200 minute_=200 minutes=194 mirror=-109 mirror_=-200
    mirror_and=-185 mirror_on=-111 mirror_then=-93 mirror_with=-93 mirrored=156 mirrored_=200
    mirrored_wall=-111 mirrors=-200 mirrors_=-93 mirrors_on=-163 misc=-140 misreading=-41
    miss=171 misses=-41 missing=-41 mission=59 mistake=161 mister=45 mistletoe=-71 mix=200
    mode=200 model=86 moment=190 money=-71 monitors=-71 mood=-41 mop=-152 mops=86 more=67
    more_=198 more_step=-111 more_steps=-140 more_than=190 morning=122 mosey=-111 most=-41
    mother=67 mother's=-41 motion=200 motionless=172 motors=172 mount=-41 mountains=-71
    mounted=-71 mouse=86 moustache=132 move=108 move_=200 move_away=-193 move_forward=-163
    move_toward=-177 moved=132 movement=200 moves=153 movie=-41 moving=134 moving_=149
    moving_walkway=-163 much=200 mud=-177 mud_room=-177 mudroom=-71 mum=153 mum's=-41
    mummies=-71 mummy=-54 mummy's=-41 mummy_and=-111 murder=86 museum=-41 museum_in=-93
    music=-140 music_room=-140 must=200 must_be=16 must_go=200 must_not=200 my=122
    my_brother=153 my_brother's=91 my_cousin's=16 my_friend=82 my_mother=67 my_old=200 myself=86
    n=172 nag=-41 nah=172 nail=-71 name=101 named=200 named_=200 nan's=86 narrator=172
    narrow=-200 narrow_hallway=-111 narrow_passage=-93 naturally=-41 nave=-93 navigation=200
    nb=86 nd=139 near=-53 near_it=-111 near_the=-129 nearer=-41 nearest=-67 nearest_mirror=-93
    nearest_the=-172 nearest_toilet=-181 nearly=16 necessary=172 need=92 need_a=71 need_is=-17
    need_not=200 need_to=18 needed=-41 needn't=-41 needs=187 negate=172 negative=101
    neighbor=-41 neighbor's=86 neighborhood=-41 neighbour=172 neither=45 nemo=-41 neon=-93
    nephew=-41 net=132 never=200 never_mind=115 new=194 newel=-71 news=200 newspaper=-71
    newspapers=-111 newspapers_=-93 newsstand=-71 next=-67 next_=182 next_door=-200
    next_left=-82 next_one=59 next_room=-163 next_to=-200 nice=-57 nicer=172 niche=-71 night=91
    nightmare=86 nightstand=-189 nightstand_=-111 nil=86 nine=-25 ninety=-181
    ninety_degrees=-111 nip=-71 no=135 no_=200 no_further=-152 no_longer=200 no_more=-140
    no_need=200 nobody=196 nomenclature=86 nominal=-41 none=200 none_of=200 nonsense=172
    nook=-141 nook_=-158 nook_and=-111 nook_with=-82 nor=86 normal=-111 north=-111
    northbound=-41 nose=-93 not=132 not_a=79 not_allow=197 not_do=200 not_enter=190 not_go=62
    not_going=16 not_in=-93 not_move=200 not_pass=31 not_right=-93 not_stop=35 not_take=124
    not_that=31 not_the=-152 not_to=69 not_turn=105 not_up=-93 not_use=142 not_walk=200
    not_where=91 note=200 notes=86 nothing=129 nothing_=200 nothing_in=45 notice=190 notice_a=45
    notice_board=-93 notice_the=200 notice_your=149 noticeboard=-41 noting=-41 november=-41
    novice=86 now=41 now_=200 now_and=161 now_go=-140 now_in=-200 now_on=200 now_so=-140
    now_there=101 now_turn=-163 now_walk=-140 now_you=-200 now_you're=-172 nowhere=-41
    nulling=-41 number=45 number_three=-111 numbers=-41 nurse=190 nurse's=-172 nursery=-200
    nursery_=-158 nursery_and=-177 nursery_then=-71 nurses=-140 nurses_station=-93 o=-140
    o'clock=-197 o'clock_and=-93 obey=200 obeyed=200 obeyed_=200 object=200 objective=-93
    oblique=-71 observation=45 obsolete=86 obstacle=-71 obstacles=-41 obvious=-41 obviously=-71
    occupies=-41 occurs=-41 ocean=-41 octagonal=-71 of=-28 of_3=-93 of_90=-111 of_a=-132
    of_all=130 of_an=-93 of_apples=-93 of_armor=-152 of_black=-93 of_chairs=-71 of_doors=-9
    of_drawers=-93 of_each=200 of_every=200 of_feet=-163 of_flags=-111 of_green=-111 of_it=-81
    of_management=163 of_one=-93 of_seats=-140 of_stairs=-200 of_steps=-152 of_tables=-93
    of_that=59 of_the=-72 of_them=-91 of_these=200 of_this=200 of_those=-111 of_three=-93
    of_what=200 of_which=-93 of_white=-111 of_windows=-111 of_you=-81 of_your=193 off=91
    off_=200 off_from=-93 off_the=-9 off_to=-111 offer=-41 office=-48 office_=-103
    office_and=-200 office_does=112 office_has=194 office_with=-120 officer=200 official=200
    offline=172 offset=-41 oh=200 oi=86 ok=200 ok_=200 okay=-49 okay_=123 okay_so=-41 okey=-41
    old=108 old_man=-93 older=-41 ollie=-41 on=-92 on_=-13 on_a=-36 on_and=-32 on_both=-127
    on_by=-93 on_down=-93 on_going=-127 on_it=-106 on_its=-200 on_left=-140 on_my=16 on_out=-93
    on_past=-172 on_right=-163 on_straight=-93 on_the=-112 on_this=31 on_through=-111 on_to=-200
    on_top=-93 on_treat=194 on_until=60 on_up=-93 on_wheels=-111 on_your=-188 once=68 once_=200
    once_and=67 once_every=149 once_so=112 once_the=-93 once_there=-93 once_you=-46
    once_you're=-111 once_you've=-93 one=-45 one's=-25 one_=-58 one_after=-93 one_and=-61
    one_at=93 one_by=91 one_deck=-93 one_door=-93 one_flight=-200 one_floor=-20 one_in=-140
    one_is=82 one_more=-111 one_of=-127 one_on=-200 one_side=60 one_step=-200 one_that=-76
    one_too=101 one_two=-93 one_up=-93 one_who=190 one_with=-200 one_you=-200 ones=59 ones_=79
    only=113 only_=200 only_and=20 only_one=-197 only_the=146 onto=-200 onto_the=-200 ooh=-71
    oops=-152 open=-140 open_=-152 open_door=-200 open_doorway=-181 open_it=-25 open_the=-172
    opening=-200 opening_=-93 opening_and=-93 opening_in=-127 opening_on=-127 opens=-200
    opens_on=-93 opera=-41 operational=172 operator=200 operator's=172 operator_has=112
    operators=172 opposite=127 opposite_=105 opposite_of=200 opposite_the=-197 optical=-41
    optional=172 options=-41 or=-10 or_down=45 or_the=-93 or_what=-111 orange=-133 orchids=-41
    order=200 order_=200 order_of=200 ordered=172 orders=200 orders_=200 orders_so=132
    orders_you=132 organ=-140 organ_pipes=-111 orientation=-41 origin=-41 other=76 other_=142
    other_end=20 other_hand=200 other_one=-152 other_side=-75 other_way=166 others=131
    otherwise=172 ottoman=-193 ottoman_=-152 ought=200 our=167 ours=-71 out=-68 out_=58
    out_and=-197 out_at=-93 out_by=-181 out_from=-93 out_in=-111 out_into=20 out_of=-119
    out_on=-152 out_onto=-200 out_past=-93 out_so=-93 out_the=8 out_there=-152 out_through=-200
    out_to=-200 out_turn=-152 outdoor=-71 outer=-41 outeray=172 outline=172 output=194
    outrank=172 outside=-113 outside_=-38 outside_and=-134 outside_it=-111 outside_of=-127
    outside_on=-140 outside_room=-93 outside_the=-200 outside_then=-82 outside_through=-111
    outvoted=86 oval=-158 oven=-138 oven_=-200 oven_and=-16 oven_on=-93 over=-45 over_by=16
    over_the=-147 over_to=-83 override=156 overview=86 overwrite=172 owes=86 own=200
    own_axis=200 owner=200 owner's=-111 owner_of=200 paces=-41 page=172 paint=-93 painted=53
    painting=-200 painting_=-158 painting_and=-82 painting_of=-127 paintings=-181
    paintings_=-163 pair=-152 pair_of=-127 pairs=-41 pajamas=-41 pal=16 pale=-41 pallet=-71
    pallets=-41 palm=-152 palms=86 pane=-41 panel=-197 panic=86 pantry=-170 pantry's=86
    pantry_=-158 pantry_and=-71 pantry_door=-25 pantry_with=-82 pants=86 papa=86 paper=-111
    papers=-41 par=-111 paragraph=172 parallel=-71 parish=-41 park=-140 parked=16 parking=-71
    parlor=45 parlour=-41 part=129 part_of=142 party=-41 pass=-157 pass_2=-103 pass_a=-200
    pass_between=-111 pass_four=-93 pass_it=9 pass_one=-111 pass_something=163 pass_the=-182
    pass_three=-181 pass_through=-111 pass_to=-140 pass_two=-200 pass_under=-93 passage=-197
    passage_and=-111 passed=45 passes=-93 passing=-152 past=-200 past_=45 past_a=-200
    past_all=-197 past_both=-140 past_every=-189 past_four=-127 past_it=-98 past_six=-111
    past_the=-200 past_them=-172 past_three=-111 past_two=-200 pat=-41 patch=-41 path=-23
    path_=-93 path_that=79 patience=172 patio=-200 patio_=-158 patio_and=-200 patio_turn=-71
    patrol=45 pause=45 pay=31 pea=-41 peanuts=-71 pears=-41 peasy=-41 pebbles=-41 pedestal=-71
    peek=-71 peel=-71 pegs=-111 penguin=-25 penguin_=16 people=-2 people_put=16
    people_sitting=-172 percent=172 perfect=-41 perform=190 pergola=-71 perimeter=172
    permission=172 permit=131 permitted=172 perpendicular=-41 persian=-71 person=200
    person_in=200 person_who=158 personnel=172 pet=86 petal=-41 pete=86 peter=172 pew=-189
    pew_=-111 pews=-197 pews_=-93 pews_on=-93 phase=-163 phone=-110 phone_=-25 phone_booth=-127
    photo=-71 photographs=-71 photos=-140 photos_on=-111 piano=-200 piano_=-200 piano_and=-147
    piano_then=-71 pianos=-120 pick=91 pick_the=-93 picture=-100 picture_=-147 picture_of=-181
    pictures=-111 piece=-71 pieces=-41 pillar=-200 pillar_=-172 pillar_and=-111 pillar_turn=-82
    pillars=-168 pillars_and=-127 pillows=-71 pinball=-111 pinball_machine=-111 pinch=-41
    ping=-172 ping_pong=-172 pink=-189 pins=-41 pipes=-163 pit=-111 pitch=-41 pivot=101
    place=200 place_=182 place_is=200 place_where=200 places=86 plan=200 plan_=200 plane=-71
    planetarium=-71 planets=-71 planned=172 plant=-200 plant_=-200 plant_and=-200 plant_in=-111
    plant_on=29 plant_take=-57 plant_turn=-134 planters=-71 plaque=-163 plaster=-41 plastic=-93
    plate=131 plates=-111 play=-71 player=-127 player_=-93 playhouse=-41 playing=-41
    playroom=-163 please=157 please_=16 please_do=200 please_don't=190 please_return=200
    please_walk=45 plinth=-41 plonk=-71 plotter=-71 pls=172 plunge=-172 plunge_pool=-172
    plus=-41 po's=-140 pocket=-41 podium=-111 point=66 point_=31 pointing=86 points=-7
    pointy=-41 poke=-41 pole=-41 poles=-41 police=200 policy=172 polish=-71 pommel=-71 pond=-7
    pong=-172 pong_table=-172 pool=-200 pool_=-163 pool_and=-200 pool_table=-200 pool_with=-93
    poor=45 pop=-111 popcorn=-172 poppet=-41 porch=-196 porch_=-124 porch_and=-158 porches=172
    port=-71 portable=-41 porthole=-111 porthole_=-93 portholes=-71 portrait=-189 portrait_=-111
    portraits=-71 portside=-41 pose=101 posh=86 position=106 post=-66 post_=-93 postcard=86
    postcards=-71 postcondition=-41 poster=10 pot=-152 pot_=-93 pots=45 pots_hanging=-93
    potted=-200 potted_palm=-127 potted_plant=-200 potted_tree=-127 pottery=-111 potting=-71
    pouffe=-41 poultry=-41 pouring=86 powder=-41 power=144 prams=-41 prayer=-71
    preconditions=-41 prep=-41 present=200 presents=-41 press=-71 pressure=-71 pretend=171
    prettiest=86 pretty=-172 previous=200 principal's=-71 principle=172 print=101 printed=200
    printer=-172 printer_=-93 printer_and=-111 printers=-71 prior=-41 priority=45 privacy=172
    private=-111 privileges=172 prize=-41 probably=86 proceed=-118 proceed_past=-177
    proceed_to=-1 projection=-41 projects=-41 pronto=-41 proof=-71 proud=-71 psst=172 pub=-41
    pucker=-41 pull=-41 pulled=-41 pulpit=-152 pulpit_=-93 pump=-71 pup's=-41 pupils=86
    puppet=-111 puppet_theater=-93 purple=-162 purposes=172 pursuant=172 push=-200 put=141
    put_=200 puts=-71 putting=-71 pyjamas=-41 q=-71 qty=-41 quarter=-71 quarters=86 query=-41
    questions=153 queue=153 quick=-66 quickly=-111 quiet=-152 quietly=-71 quilt=-71 quilts=-41
    quite=-41 r=-200 rack=-200 rack_=-200 rack_and=-200 rack_of=-140 rack_on=-111 rack_with=-111
    racks=-60 racks_=-93 racks_of=16 radiator=-163 radiator_=-140 radiators=-111 radio=132
    rail=-189 railing=-200 railing_=-181 railing_and=-140 railing_on=-181 railing_to=-152
    railings=-93 rails=-93 railway=86 rain=16 rainbow=-41 raining=-41 rally=86 ramp=-200
    ramp_=-200 ramp_and=-124 ramp_on=-93 range=-71 rather=200 rather_than=190 ray=-71 rd=-41
    reach=-100 reach_it=-111 reach_the=-122 reached=190 reached_the=158 reaching=-111
    reaching_it=-111 read=200 read_is=200 read_the=158 read_this=200 readable=86 reader=101
    reading=20 reads=115 ready=62 real=49 really=-152 rear=60 rear_door=-93 rearward=-41
    rearwards=-41 reason=200 reasons=172 recall=172 receive=172 received=86 reception=-200
    reception_=-120 reception_desk=-200 recessed=-41 recipe=-41 reciprocal=-41 recliner=-71
    recliners=-71 recon=86 record=-111 record_player=-111 recovered=86 recruit=86 red=-184
    red_carpet=-181 red_curtain=-152 red_door=-66 red_fridge=-93 red_line=-93 red_sofa=-25
    reduce=-41 reference=-41 reflection=172 reflective=-93 refrain=200 refrigerator=-200
    refrigerator_=-200 refrigerator_and=-82 refrigerator_turn=-57 refuse=172 refused=172
    regardless=172 register=-200 register_=-152 regulation=172 reinstate=172 reject=172
    relaid=-41 relax=131 relaying=86 released=172 relief=86 relieved=-71 relocation=86
    remain=194 remainder=200 remaining=45 remains=131 remark=86 remember=200 remember_to=200
    remind=-41 reminds=86 remove=172 repeat=79 repeated=131 replace=200 replaced=200
    replacement=172 report=200 reported=86 request=200 requested=172 requesting=-41 requests=172
    require=-41 required=16 requirement=-41 requires=200 rescinded=172 research=172 respect=172
    rest=200 rest_=176 rest_of=200 restaurant=-111 restaurant_and=-93 restroom=-71 restrooms=-71
    result=-71 results=86 retrace=108 retrace_your=37 return=200 return_to=200 reverse=158
    reverse_of=200 reversed=172 revert=172 revoked=172 revolution=-41 revolving=-181
    revolving_door=-181 rewarded=-41 ride=-127 riding=-41 right=-121 right's=-41 right_=-120
    right_a=-93 right_after=-200 right_again=-197 right_along=-111 right_and=-200
    right_angle=-93 right_around=-147 right_as=-49 right_at=-157 right_before=-38
    right_beside=119 right_by=-189 right_corner=-163 right_down=-93 right_go=-200
    right_hand=-151 right_immediately=-111 right_in=22 right_instead=45 right_into=-200
    right_is=20 right_just=-200 right_now=-127 right_of=-137 right_off=-93 right_on=-127
    right_one=-181 right_past=-185 right_right=-163 right_side=-200 right_so=-9 right_stop=-71
    right_take=-93 right_then=-200 right_there=-68 right_to=16 right_towards=-163 right_turn=-25
    right_until=-163 right_up=-127 right_wait=-152 right_walk=-200 right_wall=-140
    right_when=-140 right_with=-111 right_you=16 righto=-41 rights=-41 rightwards=-41 righty=-41
    rim=-41 ring=39 rink=-41 riser=-41 risers=-41 rises=-41 riverside=-197 road=-7 robes=-71
    robot=82 robot_=-8 robotics=172 robots=200 robots_must=200 rock=-41 rocking=-200
    rocking_chair=-197 rocking_horse=-93 rocks=-111 roger=86 role=172 roll=79 rolled=-127
    rolled_up=-93 roller=-71 rolling=-41 rolls=-41 roman=-71 romeo=86 roof=-31 roof_=-111
    room=-107 room's=-71 room_=-113 room_after=-29 room_and=-200 room_before=113
    room_between=-93 room_by=-127 room_door=-127 room_for=79 room_go=-127 room_has=42 room_is=31
    room_on=-200 room_opposite=-163 room_past=-93 room_straight=-127 room_that=120 room_the=-163
    room_then=-200 room_through=-134 room_to=-110 room_turn=-193 room_using=-185 room_where=-163
    room_which=-93 room_with=-179 room_you=-197 rooms=101 rooms_=141 root=172 rope=-141
    rope_barrier=-111 rot=172 rotate=62 rotate_twice=176 rotating=172 rotation=60 roughly=-71
    round=-20 round_=200 round_and=31 round_dining=-93 round_it=-111 round_table=-140
    round_tables=-111 round_the=-200 round_to=-111 round_window=16 rounded=-41 rounding=-41
    route=200 route_=200 route_and=200 route_is=200 routes=172 row=-200 row_=-140 row_and=-111
    row_of=-200 rowing=-111 rows=-189 rows_of=-163 rt=-41 rubber=-71 rubbish=45 rug=-200
    rug_=-200 rug_and=-200 rug_ends=-93 rug_in=-76 rug_to=-82 rule=190 rules=200 rumbling=86
    run=200 run_lasts=200 runner=-140 runner_rug=-111 running=-71 runs=-111 rush=-41 s=-41
    sacristy=86 saddle=-127 saddle_=-93 safe=-93 safest=172 safety=200 safety_officer=163
    said=200 said_=101 sailor=45 salad=-111 salon=-111 saloon=-71 same=-33 sandbox=-93
    sandwich=45 sanitary=-41 saturn=-71 sauna=-200 sauna_=-134 sauna_and=-120 sauna_go=-82
    sausage=-41 saw=153 say=127 say_hi=-7 say_it=200 say_that=200 saying=71 says=200 says_=200
    says_left=200 says_stop=-189 says_that=200 scale=-200 scale_=-181 scales=-93 scary=45
    scavenger=86 school=21 science=16 sconces=-71 scoot=-93 scrap=200 scratch=172 screen=-200
    screen_=-200 screen_door=-152 screens=-163 scroll=-140 scullery=-111 sculpture=-168
    sculpture_=-82 sculpture_and=-71 sculptures=-23 sea=86 sealed=172 search=153 seashells=-71
    seat=-200 seat_=-111 seat_on=-93 seating=-71 seats=-189 seats_=-111 sec=-71 second=-112
    second_=-79 second_door=-42 second_floor=-111 second_left=-111 second_one=-200
    second_right=-147 second_set=-111 second_turn=101 secondly=-41 seconds=172 secret=132
    secs=86 section=194 sectional=-93 sector=-41 secure=-93 security=136 see=-128 see_a=-106
    see_an=-158 see_if=-7 see_stairs=-93 see_that=-163 see_the=-200 see_two=-111 see_you=91
    see_yourself=-93 seek=86 seen=16 sees=86 segment=-71 select=-93 self=86 sell=86 sells=-41
    send=200 sendorfer=-140 sense=131 sensor=-41 sent=200 sentence=200 sentences=200 sentry=86
    separating=-41 separation=-41 sequence=-41 serious=86 seriously=172 served=172 server=194
    serves=-41 service=158 service_=190 serving=-41 session=172 set=-29 set_of=-200 sets=-127
    sets_of=-127 seven=-25 seventh=-71 sewing=-152 sewing_machine=-152 shade=-93 shade_=-93
    shall=198 shaped=-111 shaped_like=-93 sharp=-100 sharp_left=-200 sharp_right=-148
    sharply=-71 she=200 she's=91 shed=-7 sheets=-41 shelf=-200 shelf_=-181 shelf_and=-185
    shelf_of=-111 shelf_with=-111 shells=-41 shelves=-200 shelves_=-127 shelving=-41 shhh=-71
    shift=-93 shiny=-181 shiny_black=-93 shiny_floor=-111 ship=5 ship's=-41 ship_=16
    shipping=172 shoe=-200 shoe_display=-111 shoe_rack=-127 shoe_store=-93 shoes=-76 shoes_=-127
    shooting=-41 shop=-183 shop_=-140 shop_and=-7 shop_past=-93 shop_turn=-93 shopping=-111
    shopping_carts=-111 short=-117 short_of=-93 shorter=86 should=82 should_be=-51 should_go=200
    should_not=200 should_now=-140 should_see=-200 should_stop=-140 shoulder=172 shout=-41
    shouted=200 shouts=172 shove=-41 show=79 shower=-200 shower_=-111 shower_and=-120
    shower_room=-163 shower_turn=-71 showers=-152 shows=-41 shredder=-71 shush=86 shut=200
    shut_down=200 shutdown=172 shutters=-71 shy=-41 side=-136 side_=-152 side_and=-200
    side_as=-93 side_chapel=-111 side_door=-163 side_of=-180 side_to=-111 sideboard=-93 sides=65
    sierra=-41 sight=86 sign=-87 sign_=-79 sign_and=-172 sign_with=-111 signal=172 signed=172
    signs=-54 sill=-93 sill_=-93 silly=45 silver=-93 simple=-71 simplified=86 since=-54
    since_the=-127 sing=86 singing=-41 single=120 single_step=161 sink=-192 sink_=-200
    sink_and=-152 sink_in=50 sinks=-197 sinks_=-111 sinks_and=-152 sir=172 sister=91 sit=38
    sit_down=101 sit_on=-7 site=176 sitrep=86 sits=-140 sitting=-123 sitting_area=-111 six=-47
    six_=-7 sixth=-111 sixty=-41 size=-71 skeleton=-163 skeleton_=-93 ski=-71 skinny=-111
    skip=114 skip_the=69 skipped=172 skirt=-111 skirting=172 skis=-71 skylight=-76 skylight_=-54
    sleep=200 sleeping=45 sleeps=-41 slept=163 slide=116 slider=-140 slides=-41 sliding=-200
    sliding_door=-197 sliding_doors=-200 sliding_glass=-93 slight=-200 slight_left=-200
    slight_right=-200 slightly=-200 slightly_left=-200 slightly_right=-200 slip=-93 slope=-41
    sloping=-41 slot=-71 slow=45 slowly=-163 small=-167 small_door=-163 small_hallway=-93
    small_office=-93 small_room=-93 small_table=-185 smalls=-41 smell=-41 smells=91 smelly=-41
    smidge=-71 smile=-93 smooth=-41 snack=-111 snail=-71 snake=86 sneak=-71 snuggled=-41 so=54
    so_be=-93 so_do=178 so_find=-111 so_get=-93 so_go=-200 so_i=163 so_it's=21 so_just=-189
    so_keep=82 so_let's=-111 so_please=200 so_rotate=112 so_stop=-1 so_take=101 so_that=-160
    so_that's=-93 so_the=-163 so_turn=9 so_use=112 so_walk=-31 so_you=-39 so_you're=-163
    soak=-41 soccer=-41 socks=16 sofa=-88 sofa_=-200 sofa_and=-200 sofa_is=82 sofa_on=-82
    sofas=-25 sofas_=16 soffit=-41 soft=-25 software=172 soldier=-71 some=-15 some_stairs=16
    somebody=105 someone=190 someone's=-41 someone_else=200 something=200 something_=200
    sometimes=-41 somewhere=-111 song=-41 soon=-12 soon_as=-63 sooner=-41 soonest=86 sooo=132
    sore=86 sorry=15 sort=-41 sound=45 sounds=86 soup=86 soup's=86 source=-41 spa=-36 spa_=-16
    space=67 space_between=-93 span=-41 sparkling=-41 speaker=123 speaker_=16 speakers=-41
    speaking=200 special=172 species=-41 specifically=-41 speed=131 spiders=-71 spin=170
    spin_around=120 spin_on=200 spinning=-93 spiral=-200 spiral_staircase=-189 split=86
    splits=-197 spoken=172 sports=-41 spot=69 spot_=39 spot_a=-93 spring=86 squad=-71 square=-5
    square_table=-82 squares=-41 squeaks=-41 squeeze=-127 squirts=-41 squishy=-41 st=-71
    stable=-71 stack=-127 stack_of=-127 stacked=-140 staff=9 staff_only=-163 stage=-193
    stage_=-140 stage_and=-111 stage_up=-93 stain=-71 stained=-111 stained_glass=-111 stair=-172
    stair_=-93 staircase=-135 staircase_=-200 staircase_and=-163 staircase_on=-93 staircases=16
    stairs=-93 stairs_=-62 stairs_all=-111 stairs_and=-128 stairs_are=-111 stairs_beside=-93
    stairs_but=-111 stairs_down=20 stairs_go=-127 stairs_going=-7 stairs_next=-163
    stairs_not=-127 stairs_on=-127 stairs_take=-140 stairs_that=31 stairs_then=-172
    stairs_to=-200 stairs_turn=-200 stairs_up=-111 stairs_which=-93 stairs_with=-181
    stairway=-200 stairway_=-172 stairway_and=-134 stairway_on=-82 stairwell=-163 stall=-93
    stalls=-71 stand=-12 stand_=41 stand_and=-71 stand_by=48 stand_in=45 stand_next=-158
    stand_still=158 stand_then=-57 stand_turn=-93 stand_with=-200 standard=-41 standing=-100
    standing_in=-200 standing_on=-111 stands=-71 star=-111 star_=-93 starboard=-111 staring=-41
    stars=-71 start=80 start_=200 start_at=-127 start_by=-200 start_in=-172 start_there=-93
    start_with=101 started=200 starting=-21 starting_at=-177 state=-41 station=-200 station_=-93
    station_and=-163 stationary=-41 statue=-200 statue_=-200 statue_and=-147 statue_of=-189
    status=172 stay=189 stay_=200 stay_here=200 stay_in=106 stay_on=-152 stay_put=200
    stay_there=106 stay_where=200 stayed=86 staying=-93 stays=-41 steady=-41 steam=-181
    steam_room=-163 steel=-181 steeply=-41 steer=86 steering=131 step=-17 step_=42 step_and=55
    step_away=-163 step_inside=-93 step_into=-200 step_of=161 step_out=-81 step_over=-200
    step_stop=-82 step_turn=-127 stepping=-111 steps=-56 steps_=-1 steps_and=-177
    steps_down=-200 steps_forward=-140 steps_go=-111 steps_going=-93 steps_into=-111
    steps_on=-158 steps_then=-193 steps_to=-200 steward=-41 stick=-41 sticks=-93 still=175
    still_=200 stinky=-41 stn=-41 stone=-200 stone_bench=-93 stone_floor=-111 stone_stairs=-93
    stone_steps=-163 stones=-71 stool=-200 stool_=-200 stool_and=-127 stool_then=-71
    stool_with=-93 stools=-200 stools_=-181 stools_and=-127 stools_to=-71 stools_turn=-82
    stoolss=-23 stop=-148 stop_=-100 stop_1=-172 stop_a=-172 stop_and=-15 stop_as=79
    stop_at=-200 stop_before=-117 stop_behind=-200 stop_beside=-200 stop_between=-200
    stop_by=-200 stop_facing=-177 stop_here=86 stop_in=-200 stop_inside=-197 stop_is=190
    stop_just=-200 stop_near=-44 stop_next=-200 stop_now=200 stop_on=-200 stop_once=-163
    stop_outside=-200 stop_right=-200 stop_there=-200 stop_to=-163 stop_under=-200
    stop_when=-141 stop_where=43 stop_with=-152 stopped=101 stopping=43 stopping_=190 stops=-71
    store=-172 store_=-127 storeroom=-41 storey=-41 story=172 stove=-172 stove_=-124
    stove_and=-185 stove_in=-93 stove_past=-93 straight=-200 straight_=-79 straight_across=-200
    straight_ahead=-200 straight_and=-152 straight_between=-193 straight_down=-200
    straight_into=-163 straight_on=-17 straight_out=-200 straight_past=-200 straight_then=-82
    straight_through=-132 straight_to=-200 straight_until=-200 straight_with=-93 stranger=86
    streamers=-71 street=-140 stretcher=-71 stretching=-41 string=131 stringed=-41 strings=-71
    strip=-41 striped=-200 striped_blanket=-93 striped_rug=-111 strips=-41 stripy=-93 stroll=-41
    stroll_through=16 strollers=-41 stuck=200 student=16 studio=-7 studio_=-93 study=-200
    study_=-163 study_and=-189 stuff=194 stuffed=-111 stuffed_bear=-111 stuffy=-41
    subheading=-93 subj=86 subject=45 submarine=86 success=200 successive=-41 such=-93 sugar=-41
    suit=-152 suit_of=-152 suitcase=-41 suitcases=-41 summer=-41 sump=-41 sun=-193 sun_room=-158
    sunburn=86 sundays=86 sundial=-71 sunflowers=-71 sunken=-25 sunken_living=16 sunny=-41
    sunroom=-181 sunroom_=-93 sunshine=-41 super=-71 supersedes=172 superstar=-41 supervisor=200
    supplies=86 support=172 sure=82 surface=-71 sushi=-41 suspended=172 swan=-71 swap=200
    swap_left=200 swapped=-140 sway=-41 swear=132 sweep=-41 sweet=-127 sweet_little=-93
    sweetheart=-41 sweetie=-41 swimming=16 swimming_pool=16 swing=-200 swing's=-41 swing_=-163
    swing_and=-111 swinging=-163 swinging_doors=-127 swings=-41 swingy=-41 switch=91
    switched=172 switches=-140 swivel=-93 swore=86 sworn=-41 system=200 t=-152 t_=-93
    t_junction=-93 ta=-41 tabel=-140 table=-195 table_=-200 table_and=-200 table_around=-71
    table_at=-93 table_between=-93 table_go=-93 table_head=-57 table_in=-158 table_is=45
    table_keeping=-127 table_on=-200 table_so=-134 table_that=-111 table_then=-200 table_to=9
    table_turn=-120 table_walk=-111 table_where=-127 table_with=-200 tables=-61 tables_=-140
    tables_with=-93 tada=-41 tail=-93 take=-44 take_a=-101 take_about=-93 take_it=-181
    take_one=-127 take_the=-77 take_two=45 take_you=-152 taken=200 takes=-41 taking=16 talk=132
    tall=-183 tall_chair=-93 taller=-41 tallest=-71 tan=-193 tan_chair=-57 tank=-200 tank_=-200
    tank_and=-168 tank_then=-82 tape=-152 taped=-41 tapestry=-200 tapestry_=-134
    tapestry_and=-82 tapestrys=-23 target=79 task=197 task_=200 tasking=-41 tastes=-41 taxi=86
    tea=-127 teacher=172 teacher's=-140 teacher's_desk=-140 teal=-71 team=200 technician=200
    technician_with=200 teddies=-71 teddy=86 teenager's=-41 teeny=-127 teh=172 telephone=-111
    telescope=-172 telescope_=-152 television=-200 television_=-200 television_and=-82
    television_then=-57 televisions=-23 tell=200 tell_you=200 teller=-25 teller_windows=16
    telling=194 tells=200 tells_you=200 telly=-71 tempting=-41 ten=165 tenner=86 tennis=86
    tent=-163 tent_=-140 term=-41 terminal=-41 terminate=-71 terminates=-71 terminating=-41
    terms=172 terrace=-117 terrace_=-54 terrace_and=-93 terrible=86 test=172 text=200
    text_says=200 text_you=149 than=138 than_the=79 thank=200 thank_you=200 thanks=161 that=96
    that's=-155 that's_a=-54 that's_all=-93 that's_at=-93 that's_closest=-93 that's_got=-127
    that's_it=-152 that's_on=-93 that's_shaped=-93 that's_the=-189 that's_where=-124
    that's_your=-140 that_=182 that_and=-111 that_are=158 that_door=-197 that_follow=163
    that_follows=200 that_go=-111 that_goes=104 that_has=-200 that_is=99 that_it=51
    that_looks=53 that_means=-93 that_none=200 that_one=-53 that_robots=200 that_room=161
    that_says=-197 that_the=101 that_was=200 that_way=92 that_you=200 the=-50 the_3=-71
    the_administrator=200 the_aisle=-200 the_alarm=-163 the_alcove=-111 the_altar=-197
    the_aquarium=-152 the_arch=-200 the_archway=-200 the_armchair=-172 the_art=-93 the_atm=-93
    the_attic=-117 the_automatic=-140 the_baby=-8 the_back=-162 the_balcony=-182
    the_ballroom=-181 the_bananas=-93 the_banister=45 the_bank=16 the_baptistery=-111
    the_bar=-200 the_barbecue=-140 the_barn=-140 the_barrels=-111 the_base=-93 the_basement=60
    the_bath=-93 the_bathroom=-124 the_bathtub=-148 the_bay=-172 the_bead=-93 the_beaded=-93
    the_bed=-175 the_bedroom=-44 the_beds=-127 the_beginning=200 the_bell=-140 the_bench=-200
    the_bicycle=-140 the_bidet=-93 the_big=-200 the_biggest=-93 the_bike=-111 the_bikes=-111
    the_billiard=-111 the_bird=91 the_birdbath=-111 the_black=-185 the_blackboard=-127
    the_blue=-200 the_boiler=-172 the_bookcase=-200 the_bookshelf=-177 the_boot=-93 the_boss=85
    the_bottom=-200 the_bowl=16 the_brass=-93 the_bread=-93 the_break=-93 the_breakfast=-87
    the_brick=-189 the_bridge=-25 the_brochure=-111 the_brown=-168 the_bucket=-111
    the_buffet=-127 the_building=107 the_bulletin=-111 the_bunk=-200 the_bust=-152
    the_cabin=-163 the_cabinet=-181 the_cactus=-140 the_cafe=-127 the_cake=-111 the_candle=-185
    the_candles=-127 the_candy=-93 the_carpet=-200 the_carpeted=-93 the_cash=-197 the_ceiling=91
    the_cellar=-163 the_center=-163 the_cereal=-111 the_chair=20 the_chairs=-200
    the_chandelier=-200 the_changing=-152 the_chapel=-7 the_charging=9 the_chart=-111
    the_checkout=-93 the_chess=-111 the_chest=-93 the_chief=200 the_chimney=-93 the_china=-127
    the_christmas=-111 the_church=-41 the_classroom=-181 the_cloakroom=-41 the_clock=-200
    the_closed=-172 the_closest=-127 the_closet=-124 the_coat=-200 the_coats=-111
    the_coffee=-200 the_column=-103 the_columns=-93 the_computer=-111 the_concierge=-111
    the_conference=-200 the_confessional=-111 the_contrary=200 the_control=100 the_copier=-197
    the_corner=-200 the_corridor=-200 the_costumes=-93 the_couch=58 the_counter=-200
    the_courtyard=-152 the_crib=-200 the_cubbies=16 the_curtain=-200 the_curved=-163
    the_dance=-127 the_dark=-7 the_dartboard=-140 the_deck=-200 the_deep=-111 the_deer=-111
    the_den=-181 the_description=200 the_desk=-200 the_desks=-163 the_dining=-200
    the_dinosaur=-127 the_direction=45 the_directions=200 the_dishwasher=-200 the_display=-140
    the_distance=-163 the_doctor's=53 the_dog=-54 the_door=-143 the_doormat=-172 the_doors=-95
    the_doorway=-200 the_double=-200 the_dresser=-200 the_dressing=-197 the_drinking=-111
    the_drum=-172 the_drums=-127 the_dryer=-172 the_easel=-163 the_edge=-200 the_elevator=-190
    the_elevators=-163 the_end=-115 the_engine=-93 the_entrance=-66 the_entryway=-193
    the_escalator=-200 the_exercise=-158 the_exit=-70 the_eye=-111 the_family=-147 the_far=-200
    the_fence=-111 the_fern=-127 the_fifth=-111 the_filing=-111 the_fire=-19 the_fireplace=-200
    the_first=-40 the_fish=-200 the_five=-93 the_floor=-19 the_flower=-172 the_flowers=-111
    the_folding=-93 the_following=200 the_font=-127 the_foosball=-93 the_foot=-200
    the_fountain=-200 the_four=-158 the_fourth=-17 the_foyer=-114 the_freezer=-163
    the_french=-200 the_fridge=-192 the_front=-120 the_fruit=-7 the_full=-111 the_fuse=16
    the_gallery=-152 the_game=-158 the_gap=-127 the_garage=-67 the_garden=15 the_gas=-111
    the_gate=-200 the_generator=-93 the_giant=-93 the_gift=-152 the_glass=-182 the_globe=-200
    the_goal=200 the_gold=-127 the_grandfather=-177 the_grass=-111 the_gray=-193 the_green=-199
    the_grey=-172 the_grill=-200 the_guest=-200 the_guitar=-111 the_gumball=-111 the_gym=-124
    the_half=-111 the_hall=-166 the_hallway=-200 the_handrail=-111 the_hanging=-93 the_harp=-189
    the_harpsichord=-111 the_hat=-140 the_hatch=-152 the_hay=-93 the_head=190 the_heavy=-93
    the_hedge=-93 the_high=-172 the_hooks=-93 the_horse=-127 the_hospital=21 the_hot=-200
    the_hotel=-8 the_house=60 the_ice=-200 the_inner=-93 the_instruction=200 the_iron=-152
    the_ironing=-189 the_island=-189 the_jacuzzi=-134 the_jukebox=-140 the_keyboard=-7
    the_kitchen=-88 the_kitchenette=-25 the_l=-93 the_ladder=-200 the_lady=-93 the_lamp=-200
    the_landing=-199 the_large=-200 the_last=32 the_laundry=-200 the_leather=-200 the_left=-181
    the_leftmost=-93 the_letter=101 the_library=-138 the_life=-152 the_lifeboat=-93
    the_lifeboats=-111 the_lifebuoy=-93 the_lifeguard=-93 the_lift=-10 the_light=-152
    the_linen=-200 the_list=200 the_little=-200 the_living=-46 the_lobby=-200 the_locker=-93
    the_lockers=-200 the_loft=-54 the_long=-130 the_lounge=-200 the_low=-93 the_lower=-111
    the_lunch=-93 the_machine=-181 the_mailbox=-152 the_mailboxes=-172 the_main=-127
    the_mannequin=-140 the_map=200 the_marble=-200 the_massage=-103 the_master=-152 the_mat=-156
    the_metal=-200 the_meteorite=-93 the_microwave=-181 the_middle=-136 the_milk=-93
    the_mirror=-200 the_mirrored=-111 the_mirrors=-140 the_mop=-140 the_moving=-140 the_mud=-177
    the_museum=-25 the_music=-127 the_narrow=-152 the_nave=-93 the_nearest=-38
    the_newspapers=-111 the_next=50 the_nightstand=-172 the_notice=-93 the_number=31
    the_nurse's=-172 the_nursery=-200 the_nurses=-127 the_object=200 the_office=-200 the_old=82
    the_one=-26 the_ones=-93 the_open=-200 the_opening=-172 the_opposite=200 the_orange=-197
    the_organ=-140 the_other=64 the_ottoman=-163 the_outside=-127 the_oval=-93 the_oven=-148
    the_owner=200 the_painting=-158 the_pantry=-146 the_passage=-127 the_path=28 the_patio=-200
    the_penguin=16 the_people=-9 the_person=200 the_pews=-163 the_phone=-66 the_photos=-127
    the_piano=-200 the_picture=14 the_pictures=-93 the_pillar=-197 the_pinball=-111
    the_ping=-140 the_pink=-134 the_place=200 the_plan=200 the_plant=-200 the_plaque=-163
    the_playroom=-152 the_plunge=-163 the_podium=-111 the_police=200 the_pool=-200
    the_popcorn=-127 the_porch=-200 the_portrait=-152 the_poster=69 the_potted=-200
    the_pottery=-111 the_pretty=-93 the_printer=-172 the_pulpit=-140 the_puppet=-111
    the_purple=-200 the_rack=-172 the_radiator=-163 the_rail=-181 the_railing=-200 the_rain=16
    the_ramp=-200 the_reading=-127 the_reception=-200 the_record=-111 the_red=-184
    the_refrigerator=-200 the_remaining=45 the_rest=200 the_restaurant=-111 the_reverse=200
    the_revolving=-163 the_right=-158 the_robot=-189 the_rocking=-189 the_roof=21 the_room=-154
    the_rope=-163 the_round=-200 the_route=200 the_row=-200 the_rowing=-93 the_rows=-93
    the_rug=-200 the_run=200 the_safety=200 the_salad=-93 the_same=-16 the_sandbox=-93
    the_sauna=-200 the_scale=-200 the_school=-93 the_science=16 the_screen=-172
    the_scullery=-111 the_sculpture=-111 the_second=-161 the_sentence=200 the_service=101
    the_set=-127 the_sewing=-152 the_shelf=-200 the_shelves=-127 the_shiny=-140 the_shoe=-200
    the_shoes=-127 the_shop=-95 the_shopping=-111 the_short=-127 the_shower=-200
    the_showers=-152 the_side=-200 the_sign=-31 the_sill=-93 the_silver=-93 the_sink=-200
    the_sinks=-152 the_site=176 the_sitting=-111 the_sixth=-111 the_skeleton=-93
    the_skylight=-54 the_sliding=-200 the_small=-200 the_snack=-93 the_sofa=-25 the_spa=-71
    the_space=-93 the_speaker=101 the_spiral=-200 the_spot=178 the_square=-82 the_stack=-111
    the_stacked=-127 the_stage=-168 the_stained=-111 the_staircase=-200 the_stairs=-90
    the_stairway=-200 the_start=200 the_statue=-200 the_steam=-172 the_steel=-111 the_steps=-143
    the_stone=-200 the_stool=-168 the_stools=-111 the_stop=190 the_store=-93 the_stove=-200
    the_striped=-200 the_study=-200 the_suit=-140 the_sun=-185 the_sunken=-93 the_sunroom=-163
    the_supervisor=200 the_swing=-200 the_swinging=-152 the_t=-152 the_table=-52 the_tables=-140
    the_tall=-135 the_tan=-147 the_tape=-93 the_tapestry=-134 the_task=200 the_tea=-111
    the_teacher's=-140 the_telephone=-93 the_telescope=-172 the_television=-193 the_tent=-140
    the_terrace=-189 the_text=200 the_theater=-189 the_third=-177 the_three=-200
    the_threshold=-197 the_throne=-163 the_ticket=-181 the_tile=-127 the_tiles=-111
    the_tiny=-127 the_toilet=-41 the_toilets=-93 the_top=-200 the_towel=-181 the_towels=-111
    the_tower=-25 the_toy=-140 the_train=16 the_trash=-147 the_treadmill=-200
    the_treadmills=-140 the_tree=-86 the_trip=200 the_trophies=-93 the_trophy=-172
    the_trunk=-111 the_tub=-200 the_turns=200 the_turnstile=-152 the_tv=-200 the_two=-143
    the_typewriter=-93 the_umbrella=-143 the_unit=200 the_user=200 the_utility=-147
    the_vacuum=-111 the_vanity=-189 the_vase=-200 the_vault=16 the_velvet=-93 the_vending=-200
    the_very=9 the_vestibule=-93 the_volcano=-93 the_waiting=-120 the_walk=199 the_wall=-61
    the_walls=60 the_wardrobe=-200 the_washer=-158 the_washing=-200 the_water=-200 the_way=-7
    the_weight=-140 the_well=-127 the_whale=-93 the_wheelchair=-93 the_while=187 the_white=-200
    the_whiteboard=-200 the_whole=130 the_wicker=-193 the_wigs=-111 the_window=-200
    the_windows=-163 the_wine=-200 the_wobbly=-93 the_wood=-93 the_wooden=-200 the_word=158
    the_words=200 the_workbench=-140 the_wrong=200 the_yard=-140 the_yellow=-153 theater=-200
    theater_room=-152 theater_with=-93 theatre=-93 their=193 theirs=86 them=-64 them_=-51
    them_all=101 them_and=-189 them_on=-127 them_to=-163 themselves=-71 then=-200 then_a=-189
    then_after=-82 then_another=-111 then_as=-82 then_at=-140 then_bear=-103 then_climb=-103
    then_come=-111 then_continue=-120 then_cross=-200 then_descend=-120 then_down=-93
    then_enter=-140 then_follow=-193 then_go=-200 then_hang=-111 then_head=-172 then_i=-93
    then_immediately=-111 then_in=-93 then_it's=-189 then_keep=-172 then_left=-200 then_look=-93
    then_make=-103 then_move=-120 then_once=-120 then_out=-181 then_pass=-200 then_past=-200
    then_proceed=-163 then_right=-200 then_slightly=-93 then_stand=-71 then_step=-158
    then_stop=-200 then_straight=-93 then_take=-200 then_that=-93 then_the=-152
    then_there's=-189 then_through=-127 then_to=-111 then_turn=-200 then_up=-111 then_veer=-71
    then_wait=-200 then_walk=-200 then_when=-120 then_you=-200 then_you'll=-140 then_you're=-76
    there=-41 there'll=-111 there'll_be=-111 there's=-173 there's_a=-157 there's_the=-181
    there_=-49 there_and=-68 there_are=-57 there_but=-93 there_is=12 there_make=-93
    there_should=-172 there_so=-140 there_take=-93 there_turn=-111 there_was=136 there_will=-197
    there_without=-93 there_you=-93 thereafter=-41 thereof=-41 theres=-41 thermostat=-41
    these=200 these_commands=200 they=200 they'll=86 they're=-181 they've=16 they_are=200
    they_turn=-93 they_were=200 thick=-41 thin=-7 thing=-5 thing_=-7 thing_is=20
    thing_number=-93 thing_to=-66 thing_you=20 things=185 things_=153 think=126 think_of=161
    thinking=132 third=-172 third_=-189 third_desk=-93 third_door=-32 third_right=-103
    third_row=-140 third_window=-140 thirdly=-41 this=200 this_=200 this_at=197
    this_building=200 this_house=200 this_is=200 this_one=52 this_room=9 this_route=200
    this_run=200 this_says=200 this_sentence=200 this_step=120 this_task=200 this_text=200
    those=-200 those_=-93 those_and=-93 though=-54 three=-98 three_=-127 three_doors=-181
    three_is=-93 three_o'clock=-93 three_stairs=-147 three_stairway=-57 three_steps=-200
    threshold=-197 threshold_and=-197 throne=-189 throne_=-111 throne_and=-127 through=-200
    through_=-181 through_90=-93 through_a=-7 through_and=-152 through_door=-93 through_it=-88
    through_that=-189 through_the=-200 through_there=-93 throughout=131 throw=200 throwing=86
    thru=-93 thumping=-41 tick=-41 ticked=172 ticket=-200 ticket_booth=-111 ticket_machine=-111
    tickle=-41 ticks=-41 tiddles=86 tie=86 tied=-71 tiger=16 tight=-93 tile=-200 tiled=-71
    tiles=-181 tiles_=-127 till=-200 till_the=-200 till_you=-200 time=172 time_=101
    time_and=-111 time_you=200 times=133 times_=190 tinsel=-71 tiny=-200 tiny_bit=-93
    tiny_chairs=-93 tiptoe=-93 tiptoes=86 tired=86 titchy=-41 to=-16 to_=200 to_a=-200
    to_an=-163 to_be=200 to_begin=-93 to_carry=200 to_disregard=200 to_do=93 to_drop=132
    to_end=200 to_face=-200 to_find=105 to_follow=190 to_gate=-111 to_get=-110 to_go=79
    to_it=-116 to_its=-31 to_keep=-111 to_leave=200 to_look=-197 to_move=190 to_open=-140
    to_pass=-140 to_put=16 to_read=149 to_return=200 to_say=-7 to_see=39 to_sit=62 to_stand=-93
    to_stop=107 to_take=113 to_tell=200 to_that=-127 to_the=-114 to_turn=-55 to_undo=112
    to_wait=101 to_walk=182 to_where=151 to_you=200 to_your=-76 tock=-41 today=200 today's=-152
    today_=200 toddle=-71 todo=172 toes=-71 together=21 together_=91 toilet=-65 toilet_=51
    toilet_ahead=-57 toilet_and=-200 toilets=-93 told=200 told_me=200 told_to=200 tolerance=-41
    tomatoes=-71 tomb=-71 tomorrow=172 tonight=86 too=92 too_=117 too_far=-95 took=-41 tool=-93
    tool_bench=-93 toolbox=-41 tools=16 top=-200 top_=-200 top_and=-1 top_go=-93 top_of=-200
    top_turn=-111 top_you'll=-93 toss=172 touch=-152 touch_the=-111 touching=172 toward=-200
    toward_the=-200 towards=-139 towards_it=-93 towards_the=-196 towel=-200 towel_=-111
    towel_rack=-189 towels=-189 towels_=-172 tower=-76 toy=-197 toy_chest=-111 toys=-111
    trace=172 track=-93 tractor=-7 tractor_=-93 trade=172 traffic=163 train=-41 trains=-71
    trajectory=-41 trampoline=-71 transfer=-41 transition=-41 translate=-41 translating=172
    translation=-71 trap=200 trash=-197 trash_can=-197 travel=139 travels=-41 traverse=-93
    tray=-41 tread=-41 treadmill=-200 treadmill_=-200 treadmill_and=-111 treadmill_turn=-57
    treadmills=-163 treadmills_=-93 treads=-111 treasure=91 treasure's=86 treat=200
    treat_all=200 treat_the=200 tree=-123 tree_=-197 tree_and=-111 tree_in=16 treehouse=-71
    trees=-71 trestle=-71 trip=200 trolley=-41 trolleys=-71 trophies=-127 trophies_=-93
    trophy=-189 trophy_cabinet=-111 trophy_case=-152 trot=-41 trotting=-41 trough=-71 trucks=-41
    true=172 trun=-140 trunk=-111 trust=200 try=-93 trying=132 tub=-200 tub_=-200 tub_and=-140
    tub_to=-82 tucked=-41 tuesday=86 tuesdays=86 tulips=-71 tumble=-41 tummy=-41 tummy's=86
    tune=-71 tuner=-41 tunnel=86 tunr=172 turn=-92 turn_=97 turn_90=-200 turn_and=67
    turn_around=-67 turn_at=-140 turn_away=91 turn_back=200 turn_go=101 turn_into=-127
    turn_is=200 turn_left=-200 turn_right=-178 turn_round=9 turn_sharp=-197 turn_slightly=-200
    turn_so=-93 turn_to=-200 turn_toward=-93 turn_until=-93 turn_your=-200 turned=91 turning=31
    turning_on=149 turns=200 turns_=200 turnstile=-181 turnstile_=-111 turnstile_and=-93
    turnstiles=-71 tv=-200 tv_=-200 tv_and=-140 twang=-41 twelve=-197 twelve_=-93 twice=108
    twice_=101 twice_without=176 twin=16 twins=86 twirl=200 twirl_in=197 twist=-41 twit=-41
    two=-102 two_=105 two_beds=-93 two_bookshelves=-93 two_computer=-111 two_couches=-93
    two_doors=-200 two_flights=-163 two_floors=-140 two_hallways=-93 two_long=-111
    two_paintings=-93 two_pillars=-111 two_rooms=-140 two_rows=-111 two_sinks=-111
    two_staircases=16 two_steps=-21 two_three=-93 type=-71 typed=172 typewriter=-111
    typewriter_=-93 typing=131 u=-200 u_turn=-200 uh=-140 um=-163 umbrella=-160 umbrella_=-93
    umbrella_stand=-117 uncle=86 under=-77 under_it=-172 under_the=-200 underneath=45
    understand=172 understood=172 undo=200 undo_what=200 unicorn=-71 uniform=-41 unit=200
    unit_shall=190 units=198 unless=172 unlike=86 unlit=-41 unspecified=-41 until=-33 until_i=79
    until_it=-189 until_the=-20 until_you=-111 until_you're=-181 unusual=-41 up=-100 up_=37
    up_a=-140 up_all=-200 up_and=-38 up_at=-93 up_both=-54 up_by=-93 up_in=49 up_it=-127
    up_one=-200 up_or=60 up_the=-200 up_them=-197 up_there=151 up_those=-111 up_three=-200
    up_to=-200 up_two=-124 up_with=79 update=200 updated=172 upholstery=-41 upon=-41 upper=-41
    ups=-71 upside=131 upstairs=34 upstairs_=105 upstairs_in=-111 upward=86 upwards=-41 urer=172
    urn=-71 us=79 us_=-93 use=101 use_the=54 use_to=16 used=85 used_to=21 user=200 user's=172
    using=-185 using_the=-185 usually=-41 utility=-147 utility_room=-147 vacuum=-181
    vacuum_cleaner=-127 valid=200 van=16 vanity=-200 vanity_=-71 vanity_and=-134 vanitys=-23
    vase=-185 vase_=-193 vase_of=-93 vase_on=-134 vases=-163 vault=21 vault_=16 vector=-41
    veer=-200 veer_a=-93 veer_left=-140 veer_right=-103 veering=-41 vegetables=-41 vehicle=-41
    velocity=-41 velvet=-93 velvet_rope=-93 vending=-200 vending_machine=-200 veranda=-71
    verb=200 verification=-41 verify=-41 version=200 vertical=-71 very=-44 very_first=101
    vessel's=-41 vestibule=-93 vestry=-71 vests=-41 via=-197 via_the=-163 view=-172 view_=-93
    vineyard=-41 vip=86 vise=-71 visibility=86 visit=-93 visually=-41 voice=200 void=200
    void_=200 void_so=112 voids=172 volcano=-93 voted=172 w=-140 waffle=-71 waffles=86 waist=-41
    wait=-53 wait_=-30 wait_at=-200 wait_beside=-152 wait_by=-125 wait_for=158 wait_here=88
    wait_in=-200 wait_just=-177 wait_near=-185 wait_next=-200 wait_outside=106 wait_there=-200
    wait_under=-163 waiting=-41 waiting_area=-134 waiting_room=-93 wake=-41 wakes=172 wakey=86
    wales=86 walk=-132 walk_=200 walk_3=-111 walk_a=-71 walk_across=-200 walk_ahead=-163
    walk_all=-140 walk_along=-175 walk_alongside=-200 walk_around=-200 walk_away=-25
    walk_back=176 walk_behind=-93 walk_beside=-93 walk_between=-200 walk_by=-200 walk_down=-200
    walk_forward=-200 walk_from=-140 walk_in=17 walk_inside=-200 walk_into=-53 walk_on=-200
    walk_out=-142 walk_over=-127 walk_past=-200 walk_round=-93 walk_straight=-200 walk_the=-25
    walk_through=-200 walk_to=-148 walk_toward=-172 walk_towards=-77 walk_under=-200
    walk_until=-200 walk_up=-200 walked=131 walking=2 walking_=45 walking_past=-200 walks=200
    walkway=-197 walkway_to=-127 wall=-57 wall_=-119 wall_and=-33 wall_ends=-93 wall_of=79
    wall_on=-50 wall_past=-111 wall_that=101 wall_that's=-93 wall_to=31 wall_with=-181
    walled=-41 wallpaper=-111 wallpaper_=-93 walls=-15 walls_=35 walls_and=-111 wally=86
    walnut=-41 wander=60 want=-57 want_=-152 want_the=-200 want_to=-127 want_you=62 wanted=123
    wants=200 wants_you=200 ward=60 wardrobe=-81 wardrobe_=-120 wardrobe_and=-103 warm=-7
    warmer=-71 warn=-41 warranty=172 was=200 was_a=117 wash=-7 washer=-200 washer_=-134
    washer_and=-103 washing=-200 washing_machine=-200 washing_machines=-82 wasn't=-41
    wasteful=-41 watch=-76 watches=-41 watching=-41 watchtower=86 water=-200 water_cooler=-200
    water_fountain=-172 water_heater=-127 wave=-152 waving=86 waxed=-41 way=49 way_=137
    way_around=-111 way_down=-197 way_into=-93 way_is=200 way_of=-193 way_out=-152 way_over=-93
    way_round=200 way_through=-93 way_to=-72 way_up=-93 way_you=91 waypoint=120 waypoints=-41
    ways=-41 we=128 we'd=-41 we'll=-163 we're=55 we're_going=5 we're_not=101 we've=101
    we've_got=16 we_=91 we_are=200 we_can=-93 we_had=16 we_have=171 weak=86 wearing=91
    weather=86 weave=-41 weaving=-41 wedding=-111 wedge=-41 wee=16 week=86 week's=86
    weighing=-71 weight=-152 weight_bench=-93 weight_rack=-93 weights=-93 welcome=-127
    welcoming=-41 well=50 well_=-54 wellies=-71 went=-40 wept=86 were=200 were_mirrored=200
    west=86 western=-41 westward=-41 wet=60 whale=-111 what=200 what's=86 what_a=163 what_i=200
    what_is=200 what_it=190 what_the=200 what_they=190 what_this=200 what_you=200 whatever=200
    whatever_is=200 wheee=-41 wheel=31 wheel_=79 wheelbarrow=-71 wheelchair=-93 wheelchairs=-111
    wheels=129 wheels_=45 when=-91 when_the=-3 when_you=-121 when_you're=-127 when_you've=-111
    whenever=200 whenever_you=200 where=83 where_a=161 where_it=181 where_people=-127
    where_the=-200 where_there's=-93 where_they=169 where_you=161 where_you'll=-93 where_your=16
    wherever=200 wherever_it=200 which=-16 which_has=-41 which_i=16 which_is=-151 which_you=139
    whichever=-111 while=200 while_=176 whirl=172 whisky=-41 whisper=86 whispered=172 white=-200
    white_door=-181 white_tiles=-111 white_towels=-111 whiteboard=-200 whiteboard_=-172
    whiteboard_turn=-93 whizz=-71 who=200 who's=132 whoa=-41 whoever=200 whole=93 whole_way=82
    whom=172 whoopsie=-41 whopping=-41 whose=-71 why=16 wicker=-200 wicker_bench=-82 wide=-71
    wider=-140 width=131 wigs=-111 will=-61 will_be=-65 will_see=-200 willow=-71 win=16
    winch=-71 wind=86 winders=-41 window=-200 window's=-41 window_=-200 window_and=-62
    window_at=-127 window_in=-33 window_is=-127 window_seat=-163 window_then=-93
    window_turn=-120 window_with=-93 windows=-196 windows_=-197 windows_and=-93 windows_on=-127
    windowsill=-41 wine=-180 wine_bar=16 wine_cellar=-152 wine_fridge=-111 wine_rack=-200
    wing=45 wink=-71 winner=-41 wipe=172 wishing=-71 with=-92 with_a=-139 with_all=-127
    with_an=-25 with_flowers=-93 with_full=176 with_glass=-127 with_green=-93 with_it=79
    with_its=16 with_lots=-140 with_no=-111 with_round=-111 with_the=-118 with_three=-127
    with_two=-200 with_windows=-111 with_you=91 with_your=5 withdrawn=200 withdrawn_this=132
    within=69 without=-14 without_entering=-163 without_going=-172 without_moving=176
    without_stopping=101 witness=-71 wlak=-140 wobbly=-111 woke=172 woman=-111 women=-41
    won't=16 wonderful=45 wood=-200 wood_stove=-127 wooden=-200 wooden_bench=-93
    wooden_door=-200 wooden_floor=-189 wooden_pews=-111 wooden_stairs=-93 wooden_table=-140
    woof=86 word=200 words=200 work=200 workbench=-152 workbench_=-93 working=-71 workshop=-71
    worry=16 would=139 would_you=-8 wouldn't=45 wow=16 wreath=-111 wristwatch=-41 write=172
    written=200 written_=200 written_next=197 wrong=200 wrong_way=200 wrote=200 x=185
    xylophone=-71 yard=-140 yard_=-111 yaw=101 yeah=187 year=163 years=-41 yell=-41 yellow=-97
    yellow_door=16 yellow_line=-140 yellow_lines=-93 yep=-41 yes=-7 yesterday=132 yet=-7 yet_=16
    yew=-41 yo=172 yoga=-71 yonder=-41 you=60 you'd=93 you'll=-200 you'll_be=-147
    you'll_come=-189 you'll_find=-197 you'll_go=-93 you'll_notice=-93 you'll_pass=-181
    you'll_see=-200 you'll_spot=-93 you'll_stop=-93 you'll_want=-181 you're=-101 you're_at=-200
    you're_done=-181 you're_facing=-127 you're_going=-141 you're_in=-100 you're_inside=16
    you're_looking=-172 you're_not=134 you're_out=-93 you're_outside=-111 you're_standing=-189
    you're_there=-181 you've=-21 you've_gone=-54 you've_got=-127 you_=78 you_a=186 you_and=7
    you_are=89 you_at=21 you_began=200 you_begin=105 you_bump=-127 you_came=42 you_can=-51
    you_can't=-38 you_come=-104 you_did=200 you_do=200 you_don't=-40 you_enter=-168
    you_find=-111 you_for=190 you_get=-124 you_go=-146 you_have=120 you_hear=200 you_hit=60
    you_hold=101 you_in=111 you_into=-93 you_is=101 you_just=-9 you_know=152 you_leave=120
    you_like=153 you_look=16 you_make=101 you_may=45 you_might=-25 you_must=200 you_need=41
    you_on=171 you_out=79 you_pass=11 you_please=-93 you_reach=-192 you_read=200 you_remember=91
    you_see=-82 you_shall=-93 you_should=58 you_so=161 you_stand=145 you_stop=-200 you_take=-172
    you_that=200 you_the=200 you_then=-82 you_to=194 you_turn=51 you_undo=112 you_up=161
    you_wait=-111 you_walk=-3 you_want=-200 you_were=200 you_will=-200 your=19 your_back=-200
    your_destination=-140 your_developer=200 your_feet=-93 your_head=79 your_left=-200
    your_mission=101 your_operator=200 your_orders=200 your_own=200 your_right=-200
    your_route=200 your_second=-93 your_steps=37 your_stop=-93 your_stopping=-140 your_way=-200
    your_wheels=200 yours=82 yourself=14 yourself_and=-93 yourself_at=-93 yourself_in=-111
    yummy=-41 zero=67 zone=-152 zoo=86
    """
)
WORDS = {term: int(odds) / 100 for term, odds in (w.split("=") for w in _WORDS)}
