"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -0.977,
    "orders": 0.275,
    "text": 0.525,
    "annul": 0.251,
    "invert": 0.112,
    "case": 0.535,
    "halt": 0.410,
    "machine": 0.277,
    "role": 0.069,
    "authority": 0.257,
    "haste": 0.115,
    "if": -0.232,
    "me": -0.268,
    "you": -0.005,
    "third": -0.046,
    "past": 0.101,
    "not": 0.122,
    "here": -0.145,
    "time": 0.287,
    "go": 0.080,
    "has orders": 0.193,
    "has text": -0.057,
    "has annul": 0.245,
    "has invert": -0.025,
    "has case": 0.824,
    "has halt": -0.541,
    "has machine": 0.228,
    "has role": 0.149,
    "has authority": 0.188,
    "has haste": 0.111,
    "has if": 0.297,
    "has me": 0.240,
    "has you": -0.097,
    "has third": 0.073,
    "has past": 0.135,
    "has not": -0.109,
    "has here": -0.233,
    "has time": 0.321,
    "has go": 0.184,
    "hidden": 0.479,
    "alike": 1.678,
    "wide": 1.407,
    "spelled": 1.646,
    "leet": 1.892,
    "code": 0.375,
    "cipher": 1.503,
    "unknown": 0.123,
    "alien": 0.037,
    "foreign letters": 0.209,
    "late verb": 0.072,
    "no verb": 0.353,
    "on route": 0.403,
    "other things": 0.630,
    "nothing": 0.489,
    "turns": 0.082,
    "places": -0.179,
    "no place": 0.857,
    "length": -0.341,
    "short": -0.545,
    "commas": -0.605,
    "asks": 0.004,
    "exclaims": -0.241,
    "quoted": 0.741,
    "quote in": -0.159,
    "markup": 1.809,
    "role of": 0.164,
    "reported": 0.006,
    "self": 0.378,
    "about": 0.620,
    "back to text": -0.144,
    "elsewhere": 0.232,
    "annul orders": 0.109,
    "invert orders": 0.163,
    "case orders": 0.310,
    "not orders": -0.025,
    "halt nowhere": 0.317,
    "halt here": 0.390,
    "not go": 0.003,
    "both sides": 0.984,
    "case not": -0.017,
    "case go": 0.335,
    "case halt": 0.261,
    "me past": 0.102,
    "third past": 0.065,
    "you role": 0.056,
    "authority said": 0.035,
    "machine you": 0.013,
    "me no place": -0.197,
    "past no you": 0.057,
    "annul place": -0.025,
    "not place": 0.163,
    "if place": -0.124,
    "words": 0.644,
    "pairs": 0.675,
    "worst words": -0.001,
    "best words": 0.521,
}
CONTEXT: dict[str, float] = {
    "bias": 1.277,
    "own": 0.905,
    "first": -0.727,
    "last": 0.031,
    "stops early": 1.141,
    "stops before all": 0.372,
    "denies the rest": -0.383,
    "repeats the rest": -0.804,
    "neighbour": 0.455,
    "neighbours": 0.676,
    "alone": -1.146,
    "most": -2.628,
}
PART: dict[str, float] = {
    "bias": -2.376,
    "whole": -0.309,
    "orders": 0.069,
    "text": 0.343,
    "annul": 0.424,
    "invert": 0.029,
    "case": 0.733,
    "halt": 0.524,
    "machine": 0.521,
    "role": 0.077,
    "authority": 0.322,
    "haste": 0.586,
    "if": -0.422,
    "me": -0.817,
    "you": 0.199,
    "third": -0.129,
    "past": -0.206,
    "not": -0.104,
    "here": -0.354,
    "time": 0.052,
    "go": 0.401,
    "has orders": 0.037,
    "has text": 0.291,
    "has annul": 0.396,
    "has invert": 0.029,
    "has case": 0.390,
    "has halt": 0.085,
    "has machine": 0.518,
    "has role": 0.040,
    "has authority": 0.320,
    "has haste": 0.460,
    "has if": -0.163,
    "has me": -0.489,
    "has you": -0.352,
    "has third": -0.127,
    "has past": -0.070,
    "has not": -0.364,
    "has here": -0.422,
    "has time": 0.085,
    "has go": 0.020,
    "hidden": 1.760,
    "alike": 1.362,
    "wide": 0.000,
    "spelled": 0.484,
    "leet": 1.709,
    "code": 0.000,
    "cipher": 1.781,
    "unknown": 1.561,
    "alien": 0.517,
    "foreign letters": 0.058,
    "late verb": -0.246,
    "no verb": -0.321,
    "on route": 0.860,
    "other things": 0.409,
    "nothing": -0.161,
    "turns": 0.270,
    "places": -0.251,
    "no place": 0.063,
    "length": -0.339,
    "short": -0.192,
    "commas": 1.113,
    "asks": 0.106,
    "exclaims": -0.264,
    "quoted": 1.016,
    "quote in": 1.496,
    "markup": 0.000,
    "role of": 0.235,
    "reported": -0.325,
    "self": 0.096,
    "about": 0.369,
    "back to text": -0.167,
    "elsewhere": 0.393,
    "annul orders": 0.471,
    "invert orders": 0.466,
    "case orders": 0.272,
    "not orders": 0.381,
    "halt nowhere": 0.713,
    "halt here": 0.284,
    "not go": 0.657,
    "both sides": 0.990,
    "case not": 0.042,
    "case go": 0.333,
    "case halt": 0.048,
    "me past": -0.261,
    "third past": 0.266,
    "you role": -0.200,
    "authority said": 0.095,
    "machine you": 0.087,
    "me no place": -0.554,
    "past no you": -0.159,
    "annul place": 0.081,
    "not place": 0.094,
    "if place": -0.017,
    "words": 1.551,
    "pairs": 0.850,
    "worst words": -0.125,
    "best words": -0.374,
}
FRONT: dict[str, float] = {
    "bias": -3.809,
    "universal": 1.509,
    "text": 1.779,
    "person": 0.144,
    "modal": 0.335,
    "negation": 0.342,
    "style": 0.090,
    "unknown": 4.357,
    "late_verb": 0.760,
    "no_verb": 0.272,
    "landmarks": 0.111,
    "no_landmark": 1.045,
    "directions": -1.098,
    "commas": -1.353,
}
STYLE = bag(
    """
    appreciated below betake breather briefing bunch closing colleague commence complete
    completion conclude conclusion cooperation cruise day dear depart do easy effect egress
    esteemed finally finish for friend fun goes good got greetings guess happy have hello help
    hey hi hiya hm i i'm if initially juncture kind kindly let let's like lovely madam may me
    meet mosey need new nice off okay or outset permission please scoot sincere sir subsequently
    thanks that's thereafter think this transition try ultimately um upon vacate want what
    withdraw would you'll you've yourself
    """
)
_WORDS = bag(
    """
    0=134 00=165 000=113 0123=113 03=113 07=113 1=-51 10=54 112=113 12=39 120=-29 13=113 135=-29
    14=136 15=84 16=-29 168=113 1699912=113 17=113 18=-29 180=-34 180_degrees=-34 192=113
    1964=113 1_=15 1_m=-99 1_st=-21 2=-78 20=62 2016=113 2019=113 2020=113 2024=113 204=3
    214=-62 214_=-3 27=113 270=-29 2_=43 2_m=-161 2_meters=-85 2_nd=-121 2_the=-200 3=-49 30=-70
    3000=113 306=-51 308=-29 31=113 310=-29 318=113 3_5=-130 3_is=-70 3_m=-85 3_meters=-85
    3_step=-110 3_stop=-130 4=28 404=113 408=-29 4471=113 4491=113 45=-70 450=113 4567=113
    45_degrees=-70 47=113 4_=-62 4_m=-139 4_stop=-121 5=-151 5_m=-85 5_meters=-85 6=-99 61=113
    64=113 7=114 71=113 744=113 7741=113 8=62 84=113 88=113 9=-26 90=-200 90210=113
    90_degrees=-200 99=113 999=113 9_m=-85 _=200 _1=-121 _2=-139 _3=-110 _4=-99 _a=113
    _abandon=54 _across=-70 _act=88 _action=113 _actually=114 _add=136 _advance=-110 _after=-67
    _all=200 _alright=53 _always=164 _an=170 _and=-175 _any=185 _anything=91 _anyway=-36
    _are=132 _around=-70 _as=132 _ascend=-70 _assistant=200 _at=-142 _attention=176 _b=-3
    _back=-113 _be=120 _bear=-185 _bedroom=-70 _beep=199 _before=-9 _begin=-15 _behind=-17
    _bench=-3 _between=-26 _beyond=-110 _both=66 _bottom=-99 _bound=-70 _bravo=103 _bullet=-70
    _but=62 _by=200 _can=33 _cancel=200 _carry=103 _change=199 _climb=-200 _come=-83
    _consider=200 _continue=-129 _could=29 _count=129 _cross=-200 _danger=21 _descend=-168
    _did=176 _ding=62 _disregard=139 _do=83 _don't=52 _door=-17 _doorway=-70 _down=-82 _drop=200
    _each=192 _end=89 _enter=-200 _er=53 _every=192 _everyone=200 _everything=200 _exit=-200
    _face=-163 _facing=-200 _find=-157 _first=-92 _follow=-139 _following=-110 _for=200
    _forget=147 _forward=-70 _from=-49 _front=43 _full=62 _get=-151 _give=80 _go=-200 _good=141
    _guess=118 _half=-21 _hallway=28 _halt=80 _hang=-110 _have=147 _having=-147 _he=15 _he's=-42
    _head=-37 _heading=-85 _hello=200 _here=-98 _here's=12 _hey=123 _hi=132 _hmm=-21 _hold=-4
    _how=178 _how's=106 _i=124 _i'd=129 _i'll=200 _i'm=200 _i've=87 _if=186 _ignore=88
    _imagine=179 _in=41 _inside=-121 _instead=-82 _interpret=199 _into=-110 _is=196 _it=29
    _it'll=-99 _it's=43 _its=-70 _job=-85 _just=16 _keep=-106 _kindly=-38 _knock=118 _ladder=-21
    _ladies=53 _lap=-70 _last=125 _leave=-200 _left=-16 _leg=-110 _let=157 _let's=39 _line=-110
    _locate=-110 _look=-81 _make=-116 _may=-70 _maybe=113 _message=200 _might=-85 _move=-168
    _my=200 _n=-99 _never=192 _new=170 _next=-200 _no=145 _nobody=139 _not=3 _nothing=200
    _notice=200 _now=-106 _objective=-70 _of=-139 _off=-62 _oh=195 _ok=62 _okay=-66 _on=-130
    _once=-53 _one=-36 _only=163 _open=80 _our=180 _out=-200 _output=176 _over=53 _override=88
    _par=-85 _pass=-200 _past=-200 _pause=80 _perform=136 _phase=-110 _pick=113 _plan=-70
    _play=199 _please=119 _police=199 _pretend=170 _proceed=-137 _push=62 _quick=43 _rather=43
    _read=200 _remain=114 _remember=200 _repeat=200 _return=114 _reverse=10 _right=-134
    _rotate=43 _round=-39 _route=-17 _run=136 _say=157 _search=62 _second=-147 _see=-98 _set=113
    _sharp=-85 _she=3 _she's=-3 _should=129 _sit=62 _skip=69 _slide=62 _slow=-21 _so=24
    _somebody=200 _sorry=101 _spin=33 _stage=-85 _stairs=-26 _stand=-108 _start=-188
    _starting=-200 _stay=105 _step=-200 _stop=-200 _straight=-195 _swap=200 _swing=62 _switch=88
    _system=200 _take=-92 _task=147 _tell=161 _thank=199 _that=80 _that's=-11 _the=134
    _then=-200 _there=-13 _there'll=-36 _there's=-28 _thereafter=-85 _theres=-70 _these=136
    _they=87 _thing=-70 _think=199 _third=-62 _this=200 _three=-49 _through=-147 _throw=200
    _thru=-70 _time=103 _to=26 _train=-70 _translate=136 _treat=200 _turn=-180 _two=1 _u=103
    _um=-161 _under=114 _unless=199 _until=170 _up=-104 _upon=-185 _ur=80 _use=-155 _user=200
    _veer=-200 _wait=-126 _walk=-200 _water=136 _we=121 _we'll=3 _we're=21 _we've=43 _well=87
    _what=200 _whatever=200 _when=-21 _whenever=167 _where=56 _wherever=200 _while=103
    _whoever=200 _will=-70 _with=-130 _within=-110 _without=-48 _would=-50 _x=200 _yeah=106
    _yes=30 _you=-13 _you'd=22 _you'll=-75 _you're=18 _you've=170 _your=182 a=10 a_a=-110
    a_balcony=-78 a_bathroom=-85 a_bathtub=21 a_bear=-3 a_bed=93 a_bedroom=54 a_bench=-83
    a_big=-80 a_bird=62 a_bit=-14 a_black=-182 a_blue=-38 a_boat=43 a_bookcase=-90
    a_bookshelf=-99 a_bowl=-85 a_brass=-21 a_bronze=-21 a_brown=-139 a_bunch=-70 a_cabinet=-99
    a_candle=-92 a_cat=95 a_ceiling=62 a_chair=45 a_chandelier=-62 a_chapel=-70 a_choice=-70
    a_circle=121 a_clock=8 a_closed=-70 a_closet=-116 a_coffee=62 a_comfy=-70 a_corner=62
    a_corridor=-135 a_couch=48 a_couple=-200 a_crib=-85 a_cross=-70 a_curtain=-105
    a_cushion=-147 a_day=170 a_desk=-149 a_different=200 a_dining=-13 a_dog=43 a_door=39
    a_doorway=-34 a_dream=176 a_dresser=-56 a_few=-32 a_film=62 a_fire=-3 a_fireplace=-94
    a_fish=16 a_flat=95 a_floor=-99 a_fork=-130 a_fridge=80 a_friendly=-21 a_gap=-85 a_gate=-70
    a_gift=-70 a_glass=-134 a_goal=170 a_goat=147 a_good=152 a_grandfather=62 a_gray=-135
    a_green=-13 a_grey=-105 a_half=-155 a_hall=-110 a_hallway=-77 a_halt=-99 a_hard=-147
    a_hat=-70 a_heavy=-85 a_hole=28 a_horse=34 a_hot=-70 a_house=62 a_huge=-21 a_hundred=200
    a_i=-70 a_joke=199 a_kind=103 a_kitchen=-139 a_ladder=-8 a_lamp=-35 a_landing=-21
    a_large=-61 a_laundry=-92 a_left=-172 a_letter=103 a_light=80 a_lion=-85 a_little=-84
    a_lobby=-99 a_long=-40 a_lot=33 a_lovely=-3 a_low=-70 a_man=118 a_marble=-139 a_matter=136
    a_metal=-110 a_microwave=-99 a_million=103 a_minute=199 a_mirror=-8 a_mirrored=-70
    a_moment=62 a_narrow=-139 a_new=78 a_nice=-50 a_ninety=-85 a_number=3 a_nursery=-110
    a_pair=-130 a_phone=-70 a_piano=-72 a_picture=34 a_piece=62 a_pillar=-70 a_pink=-121
    a_place=103 a_plant=-8 a_pole=-70 a_pool=-67 a_popcorn=-85 a_porthole=-70 a_potted=-110
    a_pretty=-70 a_proper=-70 a_punching=-70 a_purple=-106 a_quarter=-3 a_quick=-21
    a_railing=-82 a_real=106 a_really=-70 a_red=-66 a_refrigerator=3 a_right=-200 a_road=-70
    a_robot=125 a_rocking=-110 a_room=27 a_rope=43 a_round=-85 a_route=176 a_row=-190 a_rug=77
    a_runner=-85 a_saddle=-85 a_sculpture=-78 a_seat=-130 a_second=77 a_secret=186 a_set=-151
    a_sharp=-200 a_shelf=-13 a_shiny=-85 a_ship=-50 a_short=-62 a_shower=-70 a_sign=21
    a_single=28 a_sink=-52 a_skylight=-70 a_sliding=-85 a_slight=-200 a_small=-190 a_sofa=46
    a_sort=-70 a_spiral=-85 a_square=-69 a_stack=-70 a_stained=-110 a_stair=136 a_staircase=39
    a_stand=-110 a_statue=-70 a_step=-70 a_stone=-125 a_stool=-70 a_stop=-115 a_straight=-85
    a_striped=-139 a_swan=-85 a_sweet=-85 a_table=-34 a_tall=-139 a_tan=-171 a_tapestry=-121
    a_technician=167 a_teeny=-85 a_television=-0 a_thing=62 a_tiny=-99 a_toilet=54 a_towel=-135
    a_trap=200 a_trash=-105 a_turn=-34 a_tv=-99 a_u=-174 a_vacuum=80 a_vase=-70 a_very=80
    a_waiting=-78 a_walk=136 a_wall=29 a_wardrobe=-3 a_washing=-70 a_wee=-3 a_well=62
    a_white=-143 a_whole=-99 a_wicker=-121 a_window=13 a_wine=-99 a_wood=-85 a_wooden=-171
    a_yellow=26 aa=113 abandon=88 abandon_the=54 abandoned=-29 abeam=-29 able=103 able_to=103
    abort=199 about=200 about_a=200 about_that=136 about_the=200 about_to=200 about_turn=-36
    above=197 above_the=43 above_was=199 abracadabra=-29 absence=49 absolute=49 absolutely=-29
    abt=-29 abutment=-29 accept=49 access=149 access_to=62 accessed=-29 accident=199
    accommodation=-29 accomplished=-110 according=165 accordingly=195 accordingly_=200
    account=-3 accounting=-70 accounts=-70 accounts_=-70 achoo=49 acid=113 acquaint=49
    acquire=-51 across=-200 across_from=-85 across_it=-155 across_the=-200 across_to=-85 act=200
    act_as=200 act_on=199 acting=165 action=191 action_stop=136 actions=113 actual=103
    actually=100 add=170 added=113 additional=-29 address=165 addressed=113 addressee=113
    adhered=-29 adipiscing=113 adjacent=-70 adjacent_to=-70 adjoining=-29 adjustment=-29
    admin=165 administrator=200 administrator's=-110 administrator_has=147 admire=-29
    admiring=-29 admission=-29 admitted=-29 adn=113 adorable=-29 adore=49 adorned=-29
    advance=-200 advance_along=-85 advance_to=-147 advancing=-29 adventure=49 advised=12
    afford=-51 aforementioned=-51 afraid=113 aft=-70 after=-4 after_=96 after_all=199
    after_each=200 after_every=200 after_it=-40 after_that=-77 after_the=-200 after_this=139
    afternoon=103 aftr=-29 again=10 again_=96 again_and=-8 again_around=-70 again_at=-200
    again_to=-3 against=125 against_the=125 agent=200 ago=20 agree=113 agreed=113 agreement=113
    ahead=-192 ahead_=-72 ahead_and=-161 ahead_is=62 ahead_of=-200 ahead_stop=-130 ahead_to=-85
    ahhh=-29 ahoy=49 ai=165 aid=-110 aim=-29 aiming=-29 air=-3 air_conditioner=-3 airing=-29
    airlock=-29 airplane=-51 aisle=-200 aisle_=-139 aisle_and=-147 aisle_between=-168
    aisle_is=-70 aisle_to=-121 aisle_with=-99 ajar=-29 alarm=37 alarmed=-29 alcove=-130
    alcove_on=-70 alert=165 alight=113 alighting=-29 align=-29 all=114 all_=200 all_around=-110
    all_motion=136 all_of=78 all_robots=200 all_rooms=199 all_that=200 all_the=-43 all_times=44
    all_turns=197 all_units=200 all_you=62 alley=-51 allow=159 allow_what=134 allowed=100
    allowed_to=-70 almost=-85 alone=43 alone_=62 along=-200 along_a=-70 along_it=-180
    along_that=-99 along_the=-200 along_this=-70 along_to=-85 along_until=-85 alongs=49
    alongside=-200 alongside_the=-200 alpha=62 alphabet=113 alphabetical=113 already=200
    already_=185 alright=53 alrighty=-29 also=100 altar=-200 altar_=-139 alter=-29 alters=-29
    although=55 always=193 always_do=154 always_go=136 always_take=171 always_use=66 am=200
    am_the=200 amazing=49 amble=-29 amet=113 among=-85 among_the=-70 amps=-29 an=54
    an_elevator=28 an_hour=200 an_office=-121 an_old=125 an_open=-72 an_opening=-85
    an_orange=-62 an_oval=-130 an_oven=-121 an_umbrella=-121 ancelledcay=113 anchor=-121 and=-64
    and_a=-91 and_across=-85 and_advance=-99 and_after=-71 and_all=199 and_an=-85 and_and=-70
    and_around=-17 and_as=-143 and_ascend=-85 and_at=-200 and_await=136 and_back=147 and_be=43
    and_bear=-143 and_begin=199 and_between=-85 and_by=28 and_call=62 and_carry=-161
    and_climb=-193 and_come=3 and_continue=-200 and_count=62 and_cross=-200 and_descend=-92
    and_do=147 and_don't=56 and_down=-69 and_end=200 and_enter=-200 and_er=-147 and_exit=-168
    and_face=43 and_finally=-70 and_find=-185 and_finish=147 and_follow=-140 and_from=-70
    and_gentlemen=53 and_get=15 and_give=43 and_go=-200 and_halt=-200 and_hang=-147 and_have=136
    and_he=-62 and_he's=-62 and_head=-200 and_hmm=-130 and_hold=-121 and_i=142 and_i'd=-130
    and_i'll=87 and_i'm=30 and_i've=126 and_ignore=62 and_immediately=-99 and_in=8 and_into=-200
    and_is=113 and_it=25 and_it'll=62 and_it's=-48 and_its=-3 and_just=-121 and_keep=-68
    and_leave=-41 and_left=-131 and_let=113 and_locate=-70 and_look=-8 and_make=-132
    and_move=-121 and_must=170 and_my=118 and_neither=199 and_never=200 and_no=56 and_nobody=147
    and_not=34 and_now=-24 and_on=-130 and_once=-34 and_one=37 and_only=136 and_out=-158
    and_pass=-200 and_past=-130 and_pause=-70 and_proceed=-182 and_put=43 and_relax=136
    and_remain=15 and_report=200 and_right=105 and_round=15 and_say=28 and_second=-99 and_she=15
    and_she's=-50 and_shut=136 and_slightly=-70 and_so=129 and_stand=-6 and_stay=168
    and_step=-177 and_stop=-200 and_straight=-161 and_take=-135 and_that=-87 and_that's=-200
    and_the=-71 and_then=-186 and_there=-136 and_there's=-115 and_they=122 and_they're=-21
    and_this=157 and_three=46 and_through=-200 and_to=-200 and_toward=-200 and_turn=-200
    and_two=11 and_um=-130 and_under=-70 and_up=-185 and_veer=-130 and_wait=-139 and_walk=-200
    and_we=37 and_what=55 and_when=-85 and_where=-70 and_white=-139 and_windows=-3 and_you=-51
    and_you'd=-146 and_you'll=-83 and_you're=59 and_you've=-70 angel=-29 angle=-17 angles=113
    angry=165 animal=113 annotator=165 announced=-29 announces=113 another=104 another_door=-70
    another_left=-70 answer=200 anthem=113 anticlockwise=-29 antique=-70 antonym=113 any=200
    any_door=176 any_further=173 any_more=198 any_of=174 any_room=136 anybody=84 anyhow=-3
    anyone=200 anything=200 anything_=136 anytime=113 anyway=-72 anyways=49 anywhere=200
    anywhere_=200 anywho=-29 apart=-51 apartment=95 apartment_=-70 aperture=-51 apologies=-29
    apologise=49 appearance=-29 appears=113 apple=113 apples=-85 appliance=113 applies=165
    apply=173 apply_a=62 appointed=-29 appreciated=-51 appreciative=-29 approach=54
    approach_the=-85 approached=-29 approved=199 approximately=-70 aquarium=-168 aquarium_=-85
    aquarium_and=-70 arbitrary=-29 arbor=-29 arcade=-99 arcade_=-70 arch=-200 arch_=-195
    arch_and=-174 arched=-139 arches=-99 arches_=-70 architect=113 archive=-50 archway=-200
    archway_=-200 archway_and=-182 archway_on=-99 archway_turn=-121 archways=-51 are=75 are_=200
    are_a=200 are_about=191 are_asked=95 are_at=95 are_behind=-99 are_by=-171 are_done=-58
    are_facing=-180 are_four=-85 are_given=178 are_gone=-85 are_hereby=199 are_in=-61
    are_inside=-70 are_kindly=-99 are_level=-70 are_looking=136 are_no=80 are_not=176
    are_now=-97 are_on=-147 are_out=113 are_painted=62 are_passed=-85 are_requested=-121
    are_some=-85 are_standing=-200 are_the=180 are_then=-99 are_there=34 are_three=-99 are_to=93
    are_told=200 are_two=-35 are_void=199 are_you=153 area=-200 area_=-200 area_and=-155
    area_then=-126 area_with=-158 aren't=200 arguments=113 arm=-82 arm's=-51 arm_=-36
    armchair=-97 armchair_=-177 armchair_and=-92 armchair_then=-85 armchairs=-98
    armchairs_and=-110 armor=-168 armor_=-139 armour=-51 armrest=-51 arms=-30 arms_=-139
    army=113 arnd=-29 around=-172 around_=-100 around_and=-115 around_go=-116 around_here=62
    around_it=-139 around_its=-99 around_on=62 around_so=-168 around_the=-200 around_then=-110
    around_to=-200 around_until=-147 arr=-29 arranged=-51 arrival=-85 arrive=-34 arrive_at=-130
    arrived=80 arrived_=173 arrived_at=-85 arriving=-110 arriving_at=-85 arrow=-85 arrows=-3
    arsenal=113 art=-50 artwork=-51 as=137 as_a=200 as_an=199 as_far=-92 as_i=85 as_if=158
    as_it=-3 as_long=141 as_opposed=-70 as_soon=-115 as_the=98 as_they=43 as_this=142 as_to=34
    as_well=-85 as_you=-36 as_your=200 ascend=-107 ascend_the=-180 ascended=-51 ascending=-70
    ascertain=-29 asdf=113 ash=113 ashamed=113 aside=113 ask=18 ask_that=3 ask_you=62 asked=136
    asked_to=78 asking=183 asking_for=126 asks=200 asks_that=142 asks_you=199 asleep=135
    assemble=-51 assembly=113 assignment=113 assistance=-29 assistant=200 assume=200
    assume_the=199 assumed=84 assuming=49 astray=49 at=-120 at_=-155 at_a=1 at_all=154 at_an=-85
    at_any=178 at_each=200 at_every=200 at_home=53 at_it=-84 at_its=-200 at_least=199 at_my=74
    at_once=200 at_one=62 at_that=-80 at_the=-200 at_their=-21 at_this=118 at_which=-139
    at_you=46 at_your=10 atlantic=113 atm=-85 atm_=-70 atrium=-110 atrium_to=-70 attached=-51
    attack=165 attained=-29 attempt=113 attention=39 attention_to=-130 attic=-96 attic_=-67
    attic_and=-116 attic_through=-92 attire=-29 attn=49 attractions=-29 auctioneer's=-51
    audience=-29 audio=49 auditorium=-51 aunt=132 aunt's=49 auntie=-29 auntie's=-29
    australian=113 author=113 authorise=113 authorised=84 authorities=113 authority=165
    automatic=-155 automatic_doors=-139 autumn=49 avail=-29 available=-51 aviary=-29 avoid=170
    avoided=165 aw=-29 await=113 awaited=-29 awarded=-29 aware=132 away=-12 away_=97
    away_and=103 away_from=-48 away_the=176 awful=-29 awfully=49 awning=-85 ax=-51 axis=64
    axis_=77 axis_at=66 axle=-29 aystay=113 azimuth=-29 b=26 b_4=43 b_and=-70 babe=-29
    babies=-51 baby=18 baby's=-51 baby_gate=-85 back=42 back's=-29 back_=193 back_and=114
    back_at=-24 back_door=-200 back_from=-42 back_inside=-200 back_into=3 back_is=80
    back_of=-146 back_on=-161 back_out=-119 back_past=-99 back_porch=30 back_room=-3
    back_stairs=-121 back_through=62 back_to=72 back_up=15 backing=-29 backpack=-29 backs=-70
    backslash=113 backstage=49 backward=140 backward_wherever=66 backwards=173 bad=186
    baddies=49 badly=49 bag=-130 bag_=-85 baggage=-51 bak=84 bake=113 bakery=-4 baking=49
    balcony=-137 balcony_=-200 balcony_and=-42 balcony_door=-36 bales=-51 ball=54 ballet=-51
    balloon=-51 balloons=-51 ballroom=-104 ballroom_=-85 balls=-99 balls_and=-70 balusters=-29
    balustrade=-51 bamboo=-130 banana=62 bananas=-99 bananas_=-70 band=113 bandage=49
    bandstand=-51 bang=-29 banister=3 banister_down=-70 banister_on=-70 bank=33 banned=165
    banner=-51 banquet=-70 baptismal=-51 baptistery=-85 bar=-200 bar_=-200 bar_and=-155
    bar_area=-200 bar_on=-50 bar_stool=-70 bar_stools=-200 bar_there's=-70 bar_with=-110
    barbecue=-155 barbecue_=-85 bare=-29 bark=113 barn=-155 barn_door=-85 barometer=-62
    barometer_and=-70 barometers=49 barracks=49 barre=-29 barrel=-160 barrel_=-139
    barrel_table=-85 barrels=-190 barrels_=-70 barrels_and=-139 barrier=-130 barrier_=-85
    bars=-51 barstool=-29 base=44 base_of=-70 basement=81 basement_=129 basement_stairs=-110
    basically=62 basins=-51 basket=-73 basket_=1 basket_and=-110 basketball=-99
    basketball_hoop=-70 baskets=-51 bath=-33 bath_=-99 bath_and=-70 bathrm=-29 bathrobes=-29
    bathroom=-55 bathroom_=-145 bathroom_and=-77 bathroom_but=62 bathroom_door=-121
    bathroom_is=136 bathroom_on=-135 bathroom_then=-130 bathroom_turn=-85 bathroom_with=-85
    bathrooms=113 baths=-51 bathtub=-103 bathtub_=-123 bathtub_and=-121 batteries=165
    battery=200 bawls=-29 bay=-64 bay_window=-180 bb=113 be=49 be_=200 be_a=-2 be_advised=53
    be_careful=-62 be_carried=199 be_done=200 be_entered=-85 be_facing=-200 be_found=114
    be_gone=-139 be_in=-115 be_left=62 be_looking=-21 be_made=54 be_next=-200 be_obeyed=183
    be_on=-200 be_passed=113 be_seated=-70 be_seen=-85 be_so=129 be_taken=54 be_the=11
    be_there=-3 be_turned=-70 be_understood=199 be_used=80 be_walked=62 beach=165 bead=-110
    bead_curtain=-110 beaded=-121 beaded_curtain=-121 beads=-21 beam=-70 bean=-51 beanbag=-90
    beanbags=-62 beans=-29 bear=-114 bear_=-50 bear_left=-185 bear_right=-195 bear_slightly=-99
    bear_to=-70 bearing=-82 beast=49 beat=165 beats=-29 beautiful=46 beautifully=-29 beauty=62
    because=32 because_i=77 because_it=62 because_it's=-21 because_my=53 because_of=147
    because_the=-50 because_there=-70 because_you=-70 become=176 becomes=-29 bed=-71 bed_=-159
    bed_3=-3 bed_and=-91 bed_go=-99 bed_in=-85 bed_is=200 bed_on=-131 bed_to=-121 bed_turn=-110
    bed_walk=-85 bed_with=-180 bedchamber=-51 bedding=-29 bedroom=-21 bedroom_=38
    bedroom_and=-73 bedroom_at=-110 bedroom_go=62 bedroom_past=-85 bedroom_then=-110
    bedroom_with=-188 bedrooms=80 beds=-58 beds_=-174 beds_and=-130 beds_are=62 beds_on=-70
    beehives=-51 been=200 been_a=176 been_cancelled=199 been_changed=199 been_left=62
    been_reached=43 been_told=136 beep=199 beep_=199 beer=113 beers=-29 bees=49 before=48
    before_=136 before_going=-3 before_i=30 before_it=41 before_the=-69 before_this=136
    before_we=80 before_you=95 beg=-29 began=200 began_=154 begging=113 begin=32 begin_=147
    begin_at=95 begin_by=-116 beginning=200 beginning_=170 begins=196 begins_=125 begun=84
    behalf=84 behave=199 behind=-142 behind_=43 behind_it=-200 behind_the=-165 behind_you=-142
    beige=-70 being=18 believe=-91 believe_=-36 believe_and=-70 believes=49 belive=113 bell=-77
    bell_=-130 bellhop's=-51 bells=12 bellweather=113 belong=113 belongs=113 below=200
    below_=113 below_is=199 belt=43 bench=-200 bench_=-200 bench_and=-200 bench_at=-70
    bench_in=-126 bench_stop=-70 bench_then=-85 bench_with=-70 benches=-121 benches_=-99
    bend=-110 bending=-29 bends=15 bends_to=62 beneath=-164 beneath_the=-190 berth=-70
    beside=-110 beside_=-70 beside_a=-85 beside_it=-147 beside_the=-155 best=186 bestie=-29
    bet=84 better=200 better_than=199 between=-200 between_=-130 between_the=-200
    between_them=-200 between_those=-85 between_two=-36 beyond=44 beyond_=-70 beyond_it=28
    beyond_the=51 bicycle=-168 bicycle_=-110 bicycles=-70 bidden=-29 bidding=49 bidet=-85
    bidet_and=-70 bifurcates=-29 big=-154 big_arch=-85 big_clock=-70 big_desk=-85 big_glass=-85
    big_globe=-85 big_oak=-3 big_one=-110 big_white=-70 big_window=-99 bigger=20 biggest=-121
    bike=-200 bike_=-126 bike_and=-105 bike_rack=-70 bikes=-130 bikes_=-70 bikes_and=-70
    billet=-29 billiard=-50 billiard_table=-99 billiards=-51 bin=-110 bin_=-99 bins=-3 bird=17
    bird_bath=-85 birdbath=-110 birdbath_=-85 birdcage=-51 birds=80 birds_and=62 birthday=132
    biscuit=20 bisect=-29 bit=-19 bit_left=-70 bit_of=33 bit_the=-85 bit_to=-70 bite=113
    bitter=-29 black=-200 black_and=-139 black_door=-85 black_piano=-70 black_railing=-78
    blackboard=-174 blackboard_=-121 blah=165 blame=113 blank=84 blanket=-82 blanket_=-62
    blankie=-29 blast=-29 bleachers=-51 bless=20 blew=132 blindfold=49 blink=113 bliss=-29
    blocked=28 blocks=113 blood=-51 blotchy=49 blue=-120 blue_carpet=-72 blue_chairs=-70
    blue_curtain=-70 blue_door=-62 blue_sofa=-78 blue_vase=30 blueprint=113 blurs=113 board=-31
    board_=-127 board_with=-85 boardroom=-36 boardroom_=-3 boards=-29 boardwalk=-51 boat=43
    body=62 boil=49 boiled=81 boiler=-161 boiler_=-130 bold=49 bollard=-51 bolts=-29 bomb=113
    bones=-29 bong=-29 book=49 bookcase=-200 bookcase_=-200 bookcase_and=-185 bookcase_on=-78
    bookcase_then=-85 bookcases=-110 bookcases_=-85 books=-139 bookshelf=-103 bookshelf_=-105
    bookshelf_and=-126 bookshelves=-70 boom=-29 boos=-29 boot=-121 boot_room=-70 booth=-189
    booth_=-90 booth_and=-130 booths=-121 booths_=-70 boots=-155 boots_=-85 boots_and=-85
    borders=113 boring=49 born=-51 borne=84 borrowed=49 boss=161 bot=-29 botanical=-29 both=-37
    both_=113 both_flights=-130 both_of=-4 both_sides=-147 bother=136 bottles=-121 bottles_=-70
    bottles_and=-70 bottom=-200 bottom_=-200 bottom_and=-99 bottom_of=-200 bottom_turn=-155
    bottom_you'll=-70 bottomless=113 bought=113 bound=-21 bounds=103 bouquet=-51 bow=132
    bowl=-66 bowl_=-36 bowl_of=-99 bowling=-51 box=-106 box_=-85 box_and=-70 boxes=15 boxes_=-70
    boy=165 boys=-29 brackets=113 brake=165 branch=-139 branch_on=-85 brass=-103 brass_bell=-70
    brass_handrail=-85 brass_wheel=-3 brave=84 bravo=103 brb=49 breach=-29 bread=1 bread_and=-70
    break=135 break_=147 break_room=-110 breakfast=-113 breakfast_bar=-110 breakfast_nook=-200
    breaking=20 breaks=-51 breast=-51 breath=53 breathe=43 breather=-29 breathtaking=-29
    breeze=84 brick=-164 brick_path=-70 brick_steps=-70 brick_wall=-113 bricked=-29 bricks=-3
    bride's=-29 bridge=-48 bridge_=103 bridge_and=-121 bridles=-51 brief=20 bright=-85
    bright_hallway=-70 brighter=-29 brilliant=-29 bring=77 brings=-70 brk=-29 broad=-29
    broadcast=-29 brochure=-85 brochures=-51 broke=20 broken=200 broken_=176 brolly=-29
    bronze=-49 bronze_doors=-3 broom=62 brother=157 brother's=77 brothers=-29 brought=-21
    brown=-95 brown_carpet=-85 brown_couch=-29 brown_door=-85 brown_leather=-85 brr=-29 brrr=-29
    brush=-29 brushes=-29 bttm=-29 btw=49 btwn=-99 btwn_the=-70 bubbles=-29 bubbling=-29
    bucket=-119 bucket_=-85 bucket_on=-70 buckets=-51 buddha=-51 buddy=-70 budge=113 budget=113
    buffer=113 buffet=-82 buffet_=-85 bug=113 bugs=-29 build=113 builder=49 builders=132
    building=185 building_=200 builds=-29 built=165 bulb=-70 bulkhead=-29 bullet=-21
    bulletin=-139 bulletin_board=-139 bum=-51 bump=-110 bump_into=-85 bunch=-85 bunch_of=-70
    bunk=-200 bunk_=-85 bunk_bed=-85 bunk_beds=-195 bunker=49 bunks=-85 bunting=49 burglar=113
    burgundy=-51 burnest=113 burning=165 bursting=-29 bus=81 bushes=-51 business=-3 bust=-185
    bust_=-130 bust_of=-70 bust_on=-70 busts=-51 but=22 but_a=37 but_do=3 but_don't=-130
    but_i=36 but_i'm=77 but_it's=8 but_no=-21 but_not=-113 but_only=-85 but_stop=-130
    but_that=30 but_that's=144 but_the=54 but_there=-70 but_turn=-85 but_we're=-3 but_you=-4
    but_you're=30 butler's=-29 butt=-29 butter=113 butterflies=-51 butterfly=-29 button=113
    buttons=20 buy=200 buzzer=-29 by=-66 by_=-16 by_a=64 by_facing=-200 by_going=62 by_it=-180
    by_its=62 by_means=-99 by_one=136 by_order=200 by_that=-110 by_the=-127 by_turning=-70
    by_walking=-113 by_way=-200 bye=81 bygone=-29 bypass=-29 c=-113 cabbage=113 cabin=-182
    cabin_=-70 cabin_and=-99 cabin_door=-110 cabin_turn=-85 cabinet=-200 cabinet_=-200
    cabinet_and=-188 cabinet_of=-70 cabinet_with=-85 cabinets=-188 cabinets_=-121
    cabinets_and=-85 cabins=-85 cable=165 cables=-70 cables_=-70 cabs=-29 cactus=-185
    cactus_=-110 cactuses=-3 caf=-110 cafe=-139 cafeteria=-70 cage=-99 cake=-62 cake_=-62
    cakes=-29 calendar=-29 calibration=165 call=163 call_it=114 call_the=170 called=44
    called_=-70 called_a=-8 calling=113 calls=113 calm=132 calories=-29 came=81 came_from=62
    came_in=161 camera=180 cameras=49 camp=49 can=29 can't=149 can't_be=199 can't_go=29 can_=-20
    can_and=-92 can_be=95 can_do=103 can_go=-8 can_see=-39 can_stop=-104 can_then=-121
    can_you=91 canada=113 cancel=189 cancel_the=200 cancelled=188 cancelled_=151
    cancelled_the=106 candle=-200 candle_holder=-200 candles=-190 candles_=-110 candles_and=-85
    candles_on=-85 candlestick=-51 candy=43 canned=-29 cannon=-29 cannons=-29 cannot=170
    canoe=-21 canopy=-110 cans=-130 cans_and=-70 cant=84 canteen=49 canvas=-3 capable=49
    capital=165 capitals=113 caps=-29 captain=176 captain's=-85 caption=113 capture=113 car=-61
    car_=3 car_and=-90 carbon=113 card=3 card_catalog=-99 cardies=-29 cardigan=49 cardigans=49
    cards=113 care=77 careful=-131 carefully=-51 cares=113 caretaker=113 carousel=-85
    carousel_=-85 carpet=-90 carpet's=-29 carpet_=-106 carpet_and=-143 carpet_changes=-99
    carpet_on=-85 carpet_past=-85 carpet_to=-135 carpeted=-200 carpeted_stairs=-121
    carpeted_steps=-110 carpets=43 carriage=-29 carried=200 carried_out=199 carries=-29 carry=82
    carry_on=-59 carry_out=200 carrying=-51 cars=-51 cart=-180 cart_=-110 cart_and=-70
    cartoons=113 carts=-121 carts_=-85 carved=-29 case=-82 case_=-200 case_of=43 case_on=-85
    case_walk=-105 case_with=-85 cases=-70 cash=-200 cash_register=-180 casino=-3 cask=-51
    castle=20 castles=49 cat=155 cat's=53 cat_and=199 cat_flap=-21 cat_is=103 catalog=-99
    catalog_=-70 catalogs=-29 catalogue=-29 catalogues=-29 catch=-51 catches=-29 catching=-29
    categories=113 cathedral=81 cats=113 caught=113 cause=-110 caution=-29 cease=136 ceases=-29
    cedar=-85 cedar_chest=-85 ceiling=22 ceiling_=26 ceiling_and=-70 ceiling_fan=-110 cellar=-50
    cellar_=-158 cellar_and=-8 cellar_door=-99 cello=-85 cement=-85 center=-141
    center_aisle=-110 center_with=-3 central=15 centre=-29 cereal=-130 cereal_=-85 certain=-51
    certificates=-3 chain=-51 chains=-51 chair=-40 chair_=-94 chair_and=-180 chair_at=-85
    chair_by=-121 chair_in=-70 chair_is=62 chair_nearest=-70 chair_on=-135 chair_walk=-92
    chair_with=-85 chairman=113 chairs=-47 chairs_=-79 chairs_and=-200 chairs_are=15
    chairs_on=-121 chairs_turn=-92 chaise=-29 chalkboard=-29 challenge=49 chamber=-70
    chambers=-51 champ=49 chance=84 chandelier=-200 chandelier's=-29 chandelier_=-200
    chandelier_and=-139 chandeliers=-51 change=185 change_of=170 changed=200 changed_your=134
    changes=-185 changes_from=-155 changes_to=-70 changing=-168 changing_room=-110
    changing_table=-110 chapel=-104 chapel_=-21 chapel_and=-21 chapel_through=-70 chapels=49
    chapter=113 character=113 characters=-29 charge=193 charger=165 charges=-29 charging=34
    charging_station=-17 chariot=-51 charlie=-51 charming=-29 chart=-110 chart_table=-85
    chase=113 chassis=-29 chat=84 chatbot=113 chatting=-29 cheap=132 check=29 check_in=-99
    checked=147 checkerboard=-29 checkered=-29 checkin=-29 checklist=-29 checkout=-130
    checkout_counter=-70 checkpoint=-29 checks=-29 cheeky=-29 cheerful=-51 cheers=43 cheery=-29
    cheese=147 cheeses=-51 chef=113 chefs=-29 chelsea=113 chemical=113 chequered=-29 chess=3
    chess_table=-85 chest=-160 chest_=-155 chest_of=-99 chick=-29 chief=196 chief_of=167
    child=165 child's=-51 childhood=49 children=95 children's=-99 chill=62 chimes=30 chimney=-82
    china=-174 china_cabinet=-168 chinese=-110 chips=-29 chocolate=-21 chocolate_fountain=-70
    choice=-70 choices=-29 choir=-99 choir_stalls=-85 choking=113 choo=20 choose=176
    choose_the=147 choosing=113 chop=132 chosen=84 chow=49 christmas=-39 christmas_tree=-72
    chuck=-51 chum=-29 church=-49 church_and=-85 chute=-51 cinderella=-29 cinema=49
    cinnamon's=49 circle=50 circle_and=159 circled=-29 circles=113 circuits=113 circular=-70
    circumference=-29 circumnavigate=-29 circumstances=136 circumvent=-29 clang=-29 clank=-29
    clarity=49 class=-70 classed=113 classroom=-200 classroom_=-155 classroom_and=-99 clatter=49
    clattering=-29 clause=113 claw=-70 clawed=-29 clay=-51 clean=84 cleaner=11 cleaner_=-70
    cleaning=-51 clear=-13 clear_of=-70 clear_the=-130 clearance=84 cleared=49 clerestory=-29
    clerk's=-51 clever=132 click=113 clicking=49 cliff=49 climb=-105 climb_=136 climb_down=-70
    climb_it=3 climb_the=-200 climb_to=-70 climb_up=-110 climbed=-50 climbing=-50 climbing_=-70
    climbs=113 cloakroom=-73 cloakroom_=-110 clock=-102 clock_=-200 clock_and=-200 clock_go=-92
    clock_on=-130 clock_the=-3 clocks=-41 clockwise=-61 cloister=-51 close=91 close_=28
    close_to=-70 closed=69 closed_=136 closed_door=-85 closed_doors=-110 closely=-51 closes=84
    closest=-195 closest_mirror=-85 closest_to=-121 closet=-178 closet_=-200 closet_and=-109
    closet_on=-121 closet_so=-70 closet_then=-85 closet_to=-85 closet_with=21 closets=-29
    closing=-51 cloth=-51 clothes=-146 clothesline=-29 clothing=-51 cloud=165 cloudy=113
    clue=-29 cmd=113 cn=-51 coach=113 coast=-110 coasting=-29 coat=-163 coat's=49
    coat_closet=-85 coat_hooks=-151 coat_rack=-200 coat_room=-110 coat_stand=-21 coats=-109
    coats_=-110 coats_and=-70 coats_in=-3 coats_on=-70 coca=-110 cocoa=-29 code=193 coffee=-110
    coffee_=15 coffee_machine=-82 coffee_maker=-85 coffee_table=-200 coffees=-29 coffin=-51
    coiled=-51 coin=62 coins=113 cola=-121 cold=17 colder=49 collapsed=113 colleague=49
    collect=113 collection=-51 college=49 collision=113 colonel=49 colonnade=-70 color=-51
    colored=-85 colored_glass=-85 colorful=-51 colors=-51 colour=113 coloured=-121 column=-200
    column_=-155 column_on=-85 columns=-155 columns_=-70 comb=-29 combined=-29 come=-17
    come_back=107 come_down=136 come_home=136 come_in=44 come_on=28 come_out=-200 come_to=-128
    comedian=113 comes=80 comes_=62 comes_next=199 comes_to=-130 comfort=20 comfortably=49
    comfy=3 comin=-29 coming=190 comma=113 command=200 commander=113 commander's=49 commands=200
    commands_as=142 commands_be=142 commence=-85 commencement=-51 comment=199 commit=113
    commode=20 commoners=113 companion=-29 companionway=-29 company=113 compass=43 complain=49
    complaint=113 complaints=49 complete=173 completely=28 completing=113 completion=-51
    compliance=113 compose=113 compost=-3 compression=-29 compulsory=113 computer=-200
    computer_=-165 computer_and=-147 computers=-121 concentrate=49 concept=113 concern=62
    concerned=49 concerning=113 concession=-29 concierge=-36 concierge's=-51 concierge_desk=-70
    conclude=-130 conclude_your=-85 concluded=-29 concluding=-29 conclusion=-29 concourse=-51
    concrete=-147 concrete_stairs=-70 condition=136 conditional=-29 conditioner=-3
    conditions=113 conduct=-51 conducted=-29 conf=20 conference=-200 conference_room=-200
    conference_table=-110 confess=49 confession=-29 confessional=-110 confessional_=-85
    confident=-29 confirm=-29 confuse=165 confuses=136 confusing=-29 congratulations=113
    connecting=-51 connects=113 consectetur=113 consecutive=-29 consent=113 conservatory=-17
    consider=200 consider_the=170 considerably=-51 consideration=20 considered=-29 console=-99
    console_table=-99 constant=-29 constraint=-51 consult=113 cont'd=-29 contact=-85
    contact_=-70 contagious=113 containing=-51 contains=95 contains_a=-70 content=165
    contestant=-51 context=113 continue=-105 continue_along=-70 continue_down=-193
    continue_on=-121 continue_past=-48 continue_straight=-70 continue_to=-200
    continue_until=-116 continues=-29 continuing=-51 continuous=113 contract=113 contradicts=113
    contrary=200 contrary_of=167 control=118 control_room=62 controller=113 convenience=-29
    conversation=113 convert=165 convey=-29 conveyor=-51 cooee=49 cooker=20 cookies=49
    cooking=113 cool=113 cooler=-200 cooler_=-200 cooler_and=-147 cooler_on=-78 cooperate=113
    coordinates=-29 copied=113 copier=-200 copier_=-130 copper=-85 copy=62 copy_machine=-70
    copyright=113 cordial=49 cordially=-29 corkscrew=-29 corner=-105 corner_=-153 corner_and=-99
    corner_of=-85 corner_on=-70 corner_table=-85 corner_to=-110 corner_under=-70 corner_with=-70
    corners=113 correct=113 correction=199 correctly=-29 correspondence=49 corridor=-79
    corridor_=-56 corridor_and=-161 corridor_in=62 corridor_is=-70 corridor_on=-70
    corridor_past=-139 corridor_to=-85 corridor_with=-139 corridors=-51 corrupt=113 costs=113
    costumes=-85 cot=-51 cots=-70 cotton=49 couch=23 couch_=-10 couch_and=-109 couch_on=21
    couch_turn=-105 couches=-77 couches_and=-85 could=72 could've=49 could_be=12 could_go=-99
    could_have=97 could_you=29 couldn't=-3 council=176 count=188 count_=195 count_the=28
    counted=43 counter=-116 counter_=-144 counter_and=-124 counter_clockwise=-70
    counter_turn=-99 counterclockwise=113 counting=80 country=-29 counts=200 counts_as=200
    county=132 couple=-193 couple_of=-200 course=8 court=-50 courteous=-29 courtesy=-51
    courtyard=-185 courtyard_=-70 courtyard_and=-70 cousin=81 cousin's=-3 cover=28 covered=28
    covers=20 cow=-29 coward=113 cowboy=-51 cozy=-70 cpp=113 cr=-110 crashed=113 crate=-51
    crates=20 crawl=-29 crayons=-29 creak=-29 creaking=-29 creaks=-29 cream=-110 creator=113
    creep=113 crest=-29 crew=-29 crib=-200 crib_=-168 crib_and=-121 crib_go=-70 crib_to=-70
    cribs=-29 cried=20 crikey=49 crime=113 crimson=-29 crisp=-29 crisps=49 critical=113
    crocodile=113 croissants=49 cross=-186 cross_on=-110 cross_over=-200 cross_the=-200
    cross_to=-85 crossed=10 crosses=-51 crossing=15 crossword=49 crowd=80 crumbs=84 cry=84
    crying=103 crypt=-99 crypt_=-70 crystal=-99 crystals=-29 cubbies=-3 cubicle=-139
    cubicle_and=-70 cubicles=-130 cuckoo=49 cucumbers=-51 cue=-70 cue_rack=-70 cues=-29
    culture=113 cup=-29 cupboard=3 cupboard_=80 cupboards=-29 cuppa=-29 cups=118 curiosities=-29
    curiosity=20 curl=-29 curlers=-51 currency=-51 current=200 currently=-51 curry=49
    curtain=-200 curtain_=-200 curtain_and=-200 curtain_then=-78 curtained=-85 curtains=44
    curtains_=-99 curtsy=-29 curved=-161 curved_staircase=-70 curved_stairs=-130 curves=-121
    curves_to=-85 curving=20 curvy=-51 cushion=-180 cushion_=-155 cushions=3 cushions_=-85
    custard=49 customary=103 customer=62 cut=156 cute=-70 cutest=-29 cuts=-29 cutter=-51 cuz=49
    cylinder=-29 cylinders=-51 d=3 da=-51 dad=84 daddy=-29 daddy's=20 daft=-29 damage=113
    dan=113 dance=21 dance_floor=-99 dancer=113 dancers=-51 dancing=-29 danger=21 dare=132
    dark=48 dark_=147 darker=-51 darkroom=-85 darling=103 dartboard=-161 dartboard_=-139
    dash=-29 data=113 date=200 date_=200 datum=49 dave=49 davenport=-3 dawdle=-70 day=200
    day_=194 daylight=-29 days=147 dazzling=-29 dbl=-29 dead=39 dead_ahead=-99 dear=76 death=165
    debug=113 decide=165 decided=170 decided_that=136 decimetre=-29 decision=113 deck=-121
    deck_=-99 deck_and=-70 deck_by=-70 deck_chairs=-85 deck_of=62 deck_with=-85 decking=-29
    declare=165 decode=113 decorating=113 decoration=113 decree=113 deep=37 deer=-85
    deer_head=-85 defender's=49 defined=84 definitely=-29 definition=84 deg=-29 degree=-99
    degrees=-163 degrees_=-174 degrees_and=-8 degrees_at=-70 degrees_left=-110
    degrees_right=-130 degrees_so=-70 degrees_to=-190 delay=84 delete=200 delete_the=199
    deleted=113 deli=-51 delivered=113 delivers=-29 delivery=132 delta=-51 demo=3
    demonstration=49 den=-200 den_=-143 den_and=-121 denied=113 dentist=113 dentist's=-29
    dentists=49 depart=-110 depart_from=-70 departing=84 department=12 department_=-3
    departure=-51 depicts=-29 depth=113 descend=-112 descend_the=-200 descended=-29
    descending=-99 descends=-29 descent=-51 describe=200 describe_the=178 described=200
    described_=199 describing=49 description=200 deserve=113 design=-29 designed=49 desired=-29
    desk=-200 desk_=-192 desk_and=-200 desk_is=-70 desk_on=-139 desk_the=-139 desk_to=-126
    desk_turn=-99 desk_walk=-105 desk_where=-70 desk_with=-185 desks=-144 desks_=-36
    desks_and=-99 desperate=49 dessert=-51 destination=130 destination_=62 destination_is=15
    detailed=-29 details=132 detect=-29 detected=113 detective=-51 determine=-29 detour=113
    developer=200 developer's=-110 deviate=-29 deviation=-29 device=113 devil's=49 devoted=-29
    dexter=-29 di=-29 diagonally=-155 diagonally_across=-85 diagonally_to=-85 dial=113
    dialect=113 diametrically=-29 dictated=113 dictionary=-51 did=200 did_it=103 did_last=174
    did_you=186 didn't=186 didnt=49 dies=-29 different=200 digress=49 dim=-29 ding=43 dingy=-29
    dining=-69 dining_car=-110 dining_room=-23 dining_table=-121 dinosaur=-39
    dinosaur_skeleton=-70 direct=-3 directed=-51 directing=-29 direction=63 direction_=200
    direction_and=-130 direction_of=-61 direction_you=134 directional=113 directions=200
    directions_=200 directions_are=200 directions_that=106 directly=-185 directly_ahead=-70
    directly_beneath=-70 director=113 dirt=49 dirty=20 disabled=165 disappointed=113 disaster=49
    discard=132 disclosed=-29 disco=-51 disconnect=113 discontinue=-29 discover=-29
    discovered=-29 discovery=-29 disembark=-29 disgrace=49 dish=-29 dishes=113 dishwasher=-200
    dishwasher_=-188 dishwasher_and=-116 disk=113 disobey=113 dispenser=-51 displacement=-29
    display=-200 display_=-85 display_case=-200 displayed=-29 disregard=189 disregard_all=116
    disregard_the=103 disregarded=-29 distance=26 distance_to=-130 distances=165
    distinguished=-51 distribute=113 disturbing=-51 ditch=113 diverged=113 divides=-29
    diving=-110 diving_board=-110 dizzy=-29 dj=-51 do=123 do_=200 do_a=-130 do_any=200
    do_anything=199 do_as=199 do_i=97 do_is=-72 do_it=200 do_me=-85 do_not=104 do_nothing=134
    do_only=199 do_so=136 do_that=-70 do_the=200 do_what=200 do_you=52 dock=103 dock_=147
    doctor=132 doctor's=1 document=165 dodge=-29 does=129 does_not=180 doesn't=41 dog=79
    dog's=-51 dog_=186 dog_and=-70 dog_bed=-70 dog_food=62 doggy=113 dogleg=-29 dogs=113
    doing=192 doing_so=-70 doing_the=176 dokey=-29 doll=-29 dollars=113 dolls=-70 dolor=113
    dolphin=-29 dolphins=20 dome=-110 dome_and=-85 don't=86 don't_=199 don't_climb=-85
    don't_enter=-110 don't_follow=62 don't_get=43 don't_go=-39 don't_have=107 don't_know=106
    don't_look=113 don't_mind=-21 don't_need=-70 don't_say=103 don't_stop=-8 don't_take=44
    don't_think=43 don't_touch=62 don't_turn=-130 don't_want=-70 don't_worry=30 don't_you=125
    done=91 done_=149 done_at=-70 done_once=-126 done_so=-70 done_when=-161 dong=84 donkey=132
    donotfollowtheroute=113 dont=123 dont_go=43 doomed=113 dooor=113 door=-129 door's=-29
    door_=-150 door_a=43 door_after=-70 door_ahead=-70 door_and=-200 door_at=-139 door_b=-70
    door_behind=-161 door_but=-62 door_by=-36 door_cross=-70 door_down=-3 door_go=-69 door_i=30
    door_in=-200 door_into=-139 door_is=36 door_left=-139 door_marked=-70 door_n=-70
    door_near=-85 door_nearest=-3 door_next=-155 door_not=-113 door_of=-139 door_on=-200
    door_opposite=-147 door_right=53 door_says=54 door_so=-70 door_stop=-139 door_straight=-70
    door_that=13 door_that's=-147 door_thats=-70 door_the=-180 door_then=-128 door_there=-130
    door_to=-195 door_turn=-22 door_walk=-78 door_which=-110 door_with=-200 door_without=-99
    door_you=50 doorbell=113 doorknob=113 doormat=-161 doormat_=-147 doors=-128 doors_=-145
    doors_and=-200 doors_are=54 doors_at=-139 doors_go=-158 doors_in=62 doors_into=-130
    doors_next=-70 doors_on=-185 doors_one=43 doors_onto=-70 doors_that=15 doors_then=-139
    doors_to=-110 doors_with=-85 doorstop=113 doorway=-184 doorway_=-119 doorway_and=-200
    doorway_of=-200 doorway_on=-113 doorway_then=-92 doorway_to=-155 doorway_turn=-70
    doorway_walk=-24 doorway_with=-110 doorways=-70 dor=-29 dorm=-3 dormitory=-51 double=-71
    double_doors=-200 doubled=84 doubling=-29 doubt=176 dougie=-29 doves=-51 down=-93 down_=14
    down_a=-130 down_aisle=-70 down_and=185 down_down=43 down_five=-130 down_four=-70
    down_from=-70 down_in=62 down_into=-110 down_it=-174 down_on=113 down_one=-155 down_past=-70
    down_so=113 down_some=-3 down_that=-70 down_the=-200 down_them=-155 down_there=-70
    down_three=-147 down_to=-45 down_two=-106 down_until=-70 download=113 downstairs=-36
    downward=-70 downwards=-29 dr=54 draft=165 drafting=-70 drafting_table=-70 drain=-51
    drapes=-29 draw=109 drawbridge=-51 drawer=49 drawers=-161 drawers_=-99 drawing=43
    drawing_room=-70 drawings=81 drawn=-70 dreadful=-29 dream=200 dreamt=113 dreamy=-29
    drenched=-29 dress=-51 dresser=-200 dresser_=-179 dresser_and=-78 dresser_on=-92
    dresser_then=-171 dresses=-51 dressing=-190 dressing_room=-174 dribbles=-29 dried=-51
    drifting=-29 drill=113 drink=-29 drinking=-147 drinking_fountain=-147 drinks=-85 drip=-29
    dripping=49 drips=-29 drive=161 driven=49 driver=49 drives=-29 driving=113 drop=200
    drop_the=199 drop_this=81 dropped=49 drops=-29 drown=84 drum=-185 drum_kit=-155 drums=-110
    drums_=-70 drunk=176 dry=103 dryer=-151 dryer_=-168 dryer_and=-70 dryers=-51 drying=84
    duck=-21 ducks=-29 ducts=-29 ductwork=-29 dude=49 due=43 dull=113 dumb=113 dumbbell=-29
    dumbbells=-70 dumpling=-29 dumpster=-51 dumpsters=-51 dungeon=-29 during=165 dust=132
    duties=165 duty=80 dw=-29 dying=113 e=-30 each=200 each_direction=178 each_doorway=116
    each_minute=116 each_of=136 each_other=3 each_sentence=199 each_step=129 each_time=200
    each_turn=200 eagle=-3 ear=49 earlier=200 earliest=-29 early=132 earrings=49 ears=-3
    ears_=-3 earthquake=113 ease=49 easel=-130 easel_=-70 easel_and=-99 easiest=-51 easing=-29
    east=96 easter=147 eastern=-29 easy=-4 eat=-51 eaten=132 eating=84 echo=49 echoey=20
    edge=-200 edge_=-85 edge_of=-200 edges=-51 edit=113 edition=113 editor=113 effect=195
    effect_=199 effected=-29 egg=30 eggs=62 egress=-51 egyptian=-29 eight=91 eight_chairs=-85
    eighteen=113 eighteenth=49 eighth=-51 eighty=-51 either=8 either_=49 elbow=20 elbows=-51
    elderflower=49 election=113 electrical=113 electricity=113 element=-29 elephant=28
    elephant_=-70 elevated=-29 elevation=-29 elevator=-148 elevator_=-174 elevator_and=-180
    elevator_doors=-99 elevator_is=-70 elevator_lobby=-85 elevator_turn=-70 elevators=-77
    elevators_=-147 elevators_are=62 elevators_but=-70 eleven=46 eleventh=-51 elit=113 else=199
    else's=113 else_=200 em=-99 em_=-70 email=165 emerged=-29 emergency=66 emergncy=-29 emit=199
    emma's=113 emoji=-21 emoji_=-70 employee=113 emptiness=113 empty=62 enabled=113 encoder=113
    encounter=-51 encountered=-29 encountering=-29 encrypted=113 end=-55 end's=-29 end_=-159
    end_and=1 end_at=34 end_go=-99 end_is=43 end_nearest=-70 end_of=-140 end_so=62 end_the=200
    end_this=134 end_turn=-110 end_up=55 end_where=-70 end_you'll=-70 ended=20 ending=165
    endlessly=113 ends=-102 ends_=-168 ends_at=-147 ends_turn=-70 ends_up=-70 enemy=113
    energy=113 engage=113 engine=3 engine_room=-99 engineer=165 engineers=113 engines=113
    english=113 enjoy=84 enjoying=-29 enormous=-3 enough=167 enough_to=62 ensure=-29 enter=-124
    enter_=-77 enter_a=95 enter_and=3 enter_by=-85 enter_it=-130 enter_that=136 enter_the=-200
    enter_through=-190 entered=-61 entered_=-99 entered_and=-110 entering=-9 entering_any=-70
    entering_the=-17 entertainment=-51 entire=84 entirety=-29 entrance=-188 entrance_=-36
    entrance_and=-99 entrance_hall=-85 entrance_of=-70 entrance_to=-125 entry=-147 entryway=-200
    entryway_=-168 entryway_and=-92 envelope=106 environment=-29 episode=200 episodes=113
    equal=113 equally=-29 equals=113 equipment=-51 er=-145 er_a=-85 er_i=-99 er_i'd=-70
    er_it's=-85 er_past=-99 er_the=-161 er_to=-70 er_you'd=-70 era=-29 erase=165 erehay=113
    erevy=113 erm=81 errand=113 errands=165 error=178 error_=176 erupts=-29 escalator=-200
    escalator's=-29 escalator_=-200 escalator_on=-70 escalator_up=-99 escalators=-51 escape=132
    esclator=-29 escort=49 esports=49 espresso=-51 essential=145 essential_that=145
    establishing=49 establishment=49 estate=132 esteemed=49 estimate=-29 etched=-51 ethay=113
    ethics=113 eu=113 evacuate=113 evacuation=54 even=156 evening=200 evening_=199 evenings=49
    event=-85 eventually=-29 ever=200 every=200 every_door=78 every_few=94 every_instruction=200
    every_landmark=199 every_order=116 every_room=122 every_second=199 every_step=199
    every_time=130 every_turn=200 everybody=95 everyone=194 everyone_knows=199 everything=175
    everything_=103 everything_i=176 everywhere=135 everywhere_=103 evidenced=-29 evrything=113
    eway=113 ex=-29 exact=113 exactly=200 exactly_where=199 exam=-70 example=165 exams=49
    exceed=113 exceedingly=-29 except=156 exception=165 exchange=113 exchanged=165
    exclamation=-29 exclude=-29 excluded=-29 excuse=106 execute=28 execute_a=-70 executed=84
    executing=165 execution=84 exercise=-77 exercise_bike=-168 exercise_bikes=-70 exhibit=62
    exhibition=-29 exhibits=-29 exist=113 exists=136 exit=-200 exit's=-51 exit_=-185 exit_and=44
    exit_by=-85 exit_is=-130 exit_on=-85 exit_sign=-190 exit_the=-200 exit_through=-180
    exit_to=-70 exited=-70 exiting=-29 exits=84 expanded=-29 expect=-51 expected=84 expense=-29
    expenses=113 expired=113 explain=172 explodes=113 explore=113 exploring=132 expose=113
    exposed=-29 extension=-51 extinguisher=-180 extinguisher_and=-130 extra=165 extract=-29
    extreme=20 ey=-29 eye=-8 eye_wash=-85 eyeliner=-29 eyepiece=-29 eyes=159 f=136 fab=49
    fabric=-51 face=-66 face_=43 face_away=-85 face_the=-105 faced=-70 faces=-29 facing=-200
    facing_a=-200 facing_it=-70 facing_the=-200 facing_you=62 fact=200 factory=176 failed=132
    fails=113 failure=199 fair=106 fairground=49 fairly=-70 fake=136 fall=-130 falling=-70
    falls=196 false=165 family=13 family_room=-200 famous=-29 fan=-82 fan_=-99 fancy=62 far=-114
    far_=-106 far_as=-92 far_corner=-139 far_door=-99 far_end=-111 far_left=-82 far_right=-85
    far_side=-195 far_wall=-161 farmer=113 farther=-121 farthest=-85 fashion=-29 fashioned=-29
    fast=157 faster=-29 fat=-29 father=49 faucet=49 fault=200 favor=-29 favour=-51 feathers=113
    february=113 federer=113 feed=62 feel=106 feeling=147 feet=-58 feet_=-62 feet_and=62
    feet_from=-200 feet_to=-200 fell=186 fella=49 fella's=-29 fellow=-29 fellows=49 fence=-26
    fence_=-110 fender=49 ferguson=113 fern=-106 fern_=-147 ferns=-85 fetched=-29 fetches=113
    few=-14 few_feet=-200 few_steps=9 fewer=113 fgbc=113 ficus=-4 fiddling=-29 field=-29
    fifteen=-29 fifth=-99 fifty=84 fig=-51 figures=49 file=-70 files=113 filing=-190
    filing_cabinet=-139 filing_cabinets=-121 fill=84 filled=84 fills=-29 film=28 filter=84
    final=97 final_position=43 finally=-21 find=-101 find_=136 find_a=-197 find_an=-139
    find_it=-147 find_me=-50 find_one=-21 find_the=-62 find_yourself=-139 finds=81 fine=101
    finely=113 finest=113 finger=-29 fingers=-29 finish=149 finish_the=136 finish_this=176
    finished=110 finished_=80 finishes=-29 finnish=113 fire=-35 fire_door=-82
    fire_extinguisher=-180 fire_hose=-130 fired=165 firemen=113 fireplace=-147 fireplace_=-154
    fireplace_and=-200 fireplace_in=43 fireplace_on=-78 fireplace_then=-78 fireplace_to=-70
    fires=-29 firewood=-85 firewood_=-85 firm=49 firmware=113 first=-20 first_=156 first_and=10
    first_bar=-70 first_deck=-70 first_door=-196 first_doorway=-85 first_four=62 first_is=-70
    first_landing=-180 first_left=-139 first_of=-26 first_one=78 first_opening=-139
    first_platform=-3 first_right=-106 first_room=25 first_row=-70 first_seat=-85 first_so=62
    first_step=-4 first_table=-110 first_the=-70 first_thing=34 first_time=53 first_two=-155
    first_window=-85 first_you=-85 firstly=-29 fish=-145 fish_tank=-200 fishes=113 fit=49
    fitness=-51 fits=49 fitted=-29 fitting=-147 fitting_room=-99 fitting_rooms=-99 five=6
    five_=66 five_steps=-193 fives=-29 fix=84 fixed=113 fixtures=-29 flag=-99 flag's=-29
    flagged=113 flagpole=49 flags=-110 flames=113 flank=-29 flap=-50 flat=88 flatter=113 flew=49
    flies=106 flight=-195 flight_=-70 flight_of=-200 flights=-92 flights_of=-185 fling=-29
    flip=200 flipped=199 float=62 floating=62 flood=113 floor=1 floor_=-10 floor_and=13
    floor_by=62 floor_changes=-147 floor_go=-85 floor_in=43 floor_is=200 floor_lamp=-147
    floor_not=-85 floor_turn=-70 floor_walk=-110 floorboard=-51 floors=52 floors_=15
    floors_up=-3 flop=-51 florist=-70 flour=113 flow=113 flower=-106 flower_shop=-70
    flower_stand=-85 flowered=-29 flowers=-168 flowers_=-99 flowers_on=-85 flue=49 fluff=113
    fluffy=-70 flush=113 fog=113 foggy=-29 fold=28 folded=-85 folding=-125 folding_ladder=-70
    folding_screen=-99 folks=81 follow=-57 follow_=116 follow_it=-29 follow_so=66 follow_that=43
    follow_the=-171 follow_what=199 followed=66 following=171 following_is=199
    following_steps=183 following_the=54 follows=151 follows_=157 font=-185 font_=-130
    font_and=-70 food=28 foolish=49 foosball=-110 foosball_table=-110 foot=-200 foot_of=-200
    footbridge=-110 footbridge_=-85 footnote=113 footstool=-110 footwork=-29 for=134 for_=-21
    for_a=16 for_all=200 for_an=200 for_another=136 for_every=136 for_it=91 for_me=-13
    for_my=170 for_right=181 for_ten=199 for_that=53 for_the=90 for_this=110 for_today=199
    for_you=123 for_your=91 forbid=113 forbidden=199 forbids=183 forbids_you=142 force=113
    forecast=49 foreign=113 forever=-29 forged=113 forget=200 forget_all=176 forget_the=144
    forgetting=-29 forgive=113 forgot=-85 forgotten=113 fork=-139 forklift=-62 forklift's=-29
    forks=-29 form=-99 former=81 formerly=49 forth=-29 forthcoming=-29 forty=62 forward=-123
    forward_=-131 forward_and=-130 forward_between=-121 forward_down=-70 forward_past=-180
    forward_through=-70 forward_to=-147 forward_two=-70 forwards=84 fossils=-36 found=179
    found_=174 found_it=199 founder=-51 fountain=-200 fountain_=-200 fountain_and=-99
    fountain_on=-85 four=-23 four_=15 four_paintings=-70 four_portholes=-70 four_poster=-70
    four_step=-92 four_steps=-165 four_stone=-85 four_windows=-85 fourteen=-3 fourth=-36
    fourth_door=-26 fox=113 foxtrot=-51 foyer=-178 foyer_=-116 foyer_and=-130 foyer_with=-78
    frame=-8 frame_=-70 framed=-139 frames=-29 free=161 free_to=62 freedom=84 freely=165
    freeze=113 freezer=-190 freezer_=-161 freezers=-51 freezes=-29 french=-178 french_doors=-200
    fresh=49 freshen=-29 fresher=-29 friday=165 fridge=19 fridge_=-63 fridge_and=-4
    fridge_is=113 fridge_then=-135 fridge_turn=-92 fridges=136 friend=87 friend's=49 friend_=56
    friend_and=43 friendly=-21 friends=165 frm=-51 from=38 from_=136 from_a=179 from_above=136
    from_here=100 from_it=83 from_now=200 from_that=-70 from_the=-46 from_there=-125
    from_this=200 from_where=46 from_you=91 from_your=195 front=-180 front_=-8 front_desk=-147
    front_door=-135 front_of=-200 front_pew=-70 front_row=-110 frosted=-72 frosted_glass=-72
    froze=49 frozen=136 fruit=12 fruit_bowl=-3 fry=165 ft=-121 full=46 full_access=116
    full_length=-70 full_of=-66 full_stop=195 fully=-51 fume=-70 fume_hood=-70 fun=139 fun_=62
    function=-51 functional=-29 funnel=-51 funnily=-29 funny=147 furlongs=49 furnace=-51
    furnished=-29 furniture=196 further=155 further_=78 further_notice=199 furthest=-29 fuse=96
    fuse_box=-3 fusion=113 fuss=-29 fussy=49 future=165 fyi=81 g=113 gabbing=49 gained=-51
    galleries=-29 gallery=-168 gallery_=-130 gallery_and=-85 gallery_on=-85 galley=-70 game=-50
    game_=62 game_room=-200 gangway=-51 gap=-155 gap_between=-99 garage=-89 garage_=-42
    garage_and=-85 garage_by=-110 garage_go=-78 garage_through=-99 garbage=113 garden=-26
    garden_=-42 gardener=113 gardening=-29 gas=80 gate=-114 gate_=-79 gate_and=-72 gate_in=-85
    gates=-29 gather=84 gave=200 gawp=-29 gazebo=-51 gear=84 gears=113 geese=-29 general=165
    generated=113 generator=-85 generator_=-85 generous=84 gentle=-70 gentleman=-29 gentlemen=77
    gently=-70 gents=-29 gerald=84 german=113 get=-107 get_a=80 get_in=-110 get_me=-70
    get_off=-70 get_on=-85 get_out=-114 get_there=29 get_to=-200 get_you=-36 gets=44 gets_to=62
    getting=191 ghost=176 giant=-110 gift=-180 gift_shop=-180 gilded=-29 giraffe=113 giraffes=-3
    git=113 give=103 give_it=-21 give_you=176 given=200 given_=191 gives=114 giving=-3
    glamorous=-29 glance=20 glass=-184 glass_=66 glass_and=-99 glass_case=-110 glass_door=-200
    glass_doors=-200 glass_panel=-85 glass_table=-200 glass_wall=-110 glass_walls=-85
    glass_window=-161 glasses=15 glasses_=43 glasshouse=-29 glazed=-70 glazing=-29 glide=-29
    glitters=113 globe=-195 globe_=-113 globe_and=-130 globe_on=-70 globes=-51 glove=49
    glowing=-51 glued=113 glug=-29 go=-140 go_=52 go_2=-110 go_across=-110 go_ahead=-110
    go_all=-200 go_along=-200 go_alongside=-70 go_and=-15 go_any=54 go_anywhere=200
    go_around=-200 go_as=62 go_back=102 go_backward=140 go_behind=-174 go_between=-200
    go_by=-200 go_directly=-70 go_down=-200 go_forward=-101 go_from=-161 go_halfway=-99
    go_home=200 go_in=-112 go_inside=-85 go_into=-164 go_left=-167 go_look=-70 go_near=200
    go_on=-15 go_out=-200 go_outside=-183 go_over=-17 go_past=-200 go_right=-145 go_round=-100
    go_slightly=-130 go_straight=-200 go_the=173 go_there=66 go_through=-189 go_thru=-70
    go_to=-114 go_toward=-200 go_towards=-174 go_under=-200 go_up=-200 go_upstairs=62
    go_wherever=136 go_wrong=-3 goal=200 goal_=200 goal_is=162 goals=113 goat=121 god=132
    goes=31 goes_and=-70 goes_for=136 goes_from=-3 goes_in=43 goes_past=-99 goes_right=-70
    goes_round=-85 goes_to=-130 goes_up=43 going=-61 going_=3 going_down=-59 going_in=-90
    going_left=-70 going_out=-110 going_past=-110 going_straight=-200 going_the=136
    going_through=-99 going_till=62 going_to=18 going_until=-200 going_up=-174 gold=3
    gold_frame=-70 golden=43 goldfish=49 gone=-44 gone_=-3 gone_around=-70 gone_between=-70
    gone_down=-130 gone_past=-110 gone_through=-139 gone_to=-85 gone_up=-110 gong=-70 gonna=20
    good=176 good_=126 good_morning=161 goodbye=113 goodies=-29 goooood=49 gorgeous=-85 gosh=49
    gossip=49 got=31 got_a=19 got_lost=62 got_the=36 got_to=-72 got_two=-3 gotta=-51 gowns=-29
    gps=113 grab=-29 gracious=-29 grade=113 gradient=-29 grammar=113 gramophone=-51
    gramophone's=-29 gran's=-29 grand=-36 grandad's=-29 grandfather=-140 grandfather_clock=-140
    grandma=165 grandma's=132 grandmother=172 grandpa=113 grandpa's=20 granny=81 granny's=49
    grant=113 granted=113 grass=-98 grass_=-85 grass_to=-70 grate=-29 grateful=62 grateful_if=62
    grating=-29 gravel=-70 gravel_path=-70 graveyard=-51 gray=-200 gray_metal=-70 grease=113
    great=1 great_hall=-85 greatly=-29 green=-155 green_=-110 green_and=-70 green_armchair=-3
    green_chair=-85 green_chairs=-85 green_door=-106 green_lamp=-3 green_one=-110
    green_walls=-85 greenery=-29 greenhouse=-29 greet=113 greeted=-51 grew=49 grey=-126
    grey_couch=-92 greyhound=-51 grid=49 grill=-200 grill_=-200 grille=-29 groom's=-29 ground=76
    ground_floor=33 group=165 grow=113 grown=-99 grrr=-29 guard=199 guard's=-130
    guard's_chair=-130 guardrail=-29 guardrails=113 guardroom=49 guards=165 guess=21
    guess_what=53 guessed=113 guessing=-29 guest=-55 guest_room=-200 guests=113 guidance=113
    guide=-29 guided=20 guilty=113 guitar=-85 gumball=-110 gumball_machine=-110 gun=-121
    gunner's=49 gutter=49 gym=-165 gym_=-50 gym_and=-116 gym_doors=-85 gym_with=-99
    gymnasium=-85 gyroscope=113 ha=30 hacked=113 had=189 had_a=200 had_the=126 had_to=106
    haha=103 hahaha=49 haiku=113 hair=-110 hairpin=20 half=87 half_bath=-3 half_flight=-110
    half_landing=-99 half_of=196 half_right=-70 half_way=62 halfway=-200 halfway_=-70
    halfway_down=-70 halfway_up=-85 hall=-166 hall's=-29 hall_=-150 hall_and=-179 hall_as=-70
    hall_by=-99 hall_door=-3 hall_into=-110 hall_is=-70 hall_of=-99 hall_past=-121
    hall_table=-70 hall_then=-195 hall_through=-70 hall_to=-139 hall_turn=-92 hall_until=-161
    hall_with=-139 hallway=-85 hallway's=-29 hallway_=-95 hallway_and=-154 hallway_as=-70
    hallway_by=-85 hallway_go=-92 hallway_in=-70 hallway_is=173 hallway_on=-55 hallway_past=-200
    hallway_splits=-139 hallway_then=-155 hallway_to=-180 hallway_turn=-126 hallway_with=-200
    hallways=21 hallyway=-110 halt=12 halt_=59 halt_at=-18 halt_by=-85 halt_on=-70 halt_when=-70
    halted=-70 halts=-29 hammock=-121 hammock's=-29 hammock_=-70 hamper=-110 hamper_and=-70
    hamster=-51 hand=44 hand's=113 hand_=95 hand_door=-110 hand_for=163 hand_is=199
    hand_side=-164 hand_the=136 hand_wall=30 handbrake=113 handedness=113 hander=-29 handle=-51
    handles=-70 handrail=-147 hands=161 handsome=113 handy=49 hang=-200 hang_a=-200 hangar=49
    hanging=-118 hanging_from=-70 hanging_on=3 hangs=-98 hansen=113 happen=132 happened=165
    happens=113 happy=3 harbor=-51 harbour=-29 hard=-200 hard_left=-139 hard_right=-147
    hard_to=-99 hardly=-70 hardwood=-85 harp=-131 harp_=-70 harp_and=-121 harpist=-29
    harpsichord=-99 harpsichord_=-85 has=175 has_a=-74 has_been=200 has_cancelled=106
    has_changed=200 has_closed=199 has_got=-21 has_never=136 has_no=80 has_one=103 has_the=-99
    has_to=191 has_two=-3 has_withdrawn=81 hasn't=81 hat=-48 hat_=62 hat_rack=-70 hat_stand=-121
    hatch=-119 hatch_=-147 hate=113 hated=49 hates=113 hats=-51 have=152 have_a=101
    have_arrived=50 have_been=200 have_done=136 have_found=136 have_gone=55 have_left=-3
    have_no=200 have_passed=-70 have_reached=66 have_the=117 have_to=58 have_you=101 haven't=103
    having=27 having_been=-50 hay=-110 hazy=-29 he=0 he'd=49 he'll=-51 he's=-48 he's_going=-70
    he's_on=-70 he's_out=-99 he_doesn't=-70 he_goes=-139 he_is=-85 he_stops=-110 head=-47
    head_=66 head_down=-121 head_for=18 head_of=54 head_office=200 head_on=-70 head_out=-190
    head_straight=-70 head_through=-70 head_to=-200 head_towards=-200 head_up=-70 heading=-174
    heading_you=-70 headlines=113 headmaster's=49 headquarters=132 headroom=-29 heads=43
    health=132 hear=183 hear_left=62 heard=170 hearing=-29 hears=113 heart=157 hearth=-70
    heartless=113 hearts=-29 heat=-29 heated=-99 heater=-155 heater_=-121 heater_and=-70
    heating=113 heave=-29 heavy=-43 heavy_=103 heavy_door=-70 hedge=-130 hedge_=-70 heed=165
    height=-51 held=84 helical=-29 hello=153 hello_=132 help=156 helper=113 helps=-51 hence=-3
    henhouse=49 her=78 her_right=-3 here=148 here's=41 here's_a=53 here's_your=53 here_=149
    here_and=200 here_is=49 here_on=170 here_so=200 hereby=173 herein=113 hero=132 hers=49
    hex=113 hey=123 heyyy=-29 hi=102 hi_=118 hi_to=-3 hidden=95 hide=178 hiding=113 high=6
    high_chair=-98 high_chairs=-70 higher=66 highest=-51 hill=-29 hills=84 him=11 him_=-30
    him_and=-70 himself=-51 hint=-29 hired=113 his=80 his_right=-85 hit=66 hit_the=33 hiya=81
    hm=-51 hmm=-179 hmm_left=-70 hmm_the=-70 hmm_you'd=-70 hmmmm=113 hold=3 hold_=3 hold_at=-161
    hold_by=-99 hold_on=-119 hold_position=43 holder=-200 holder_=-126 holder_and=-151
    holding=62 holds=-51 hole=37 hole_in=62 holes=49 holiday=113 hologram=113 home=200 home_=200
    homes=113 hon=-29 honest=147 honestly=132 honey=132 honor=49 honored=-29 hood=-70 hook=15
    hookah=-51 hooks=-146 hooks_=-190 hooks_and=-36 hoop=-85 hoop_=-70 hooray=-29 hoover=-70
    hop=43 hope=132 hopeless=49 hoping=-29 hopscotch=113 horizontal=62 horn=113 horse=-76
    horse's=-29 horse_=-20 horseback=-51 horses=20 hose=-147 hose_=-121 hospital=-23
    hospital_bed=-147 host=53 hot=-125 hot_tub=-200 hotel=-59 hotel_corridor=-85 hotel_room=-85
    hour=200 hour_=186 hours=200 house=115 house_=91 house_and=80 house_by=-70 house_for=62
    house_has=200 house_is=55 house_through=-70 house_you=103 household=132 housekeeping=-51
    houses=62 hover=-29 how=176 how's=126 how's_the=126 how_to=62 however=-85 hue=-29 huge=-33
    huge_orange=-3 hugs=-29 human=165 humans=113 humble=165 humbly=-70 humidity=113 humming=-29
    hums=165 hun=-29 hundred=161 hundred_and=-70 hung=-36 hungry=20 hunt=144 hup=-29 hurry=22
    hurt=113 hurting=113 hurts=113 husband=20 hush=49 hushed=49 hut=-51 hutch=-29 hymn=-51
    hypothetically=113 i=90 i'd=34 i'd_have=62 i'd_i'd=-70 i'd_like=55 i'd_say=-121 i'd_stop=-85
    i'll=181 i'll_be=53 i'll_have=-3 i'll_say=106 i'll_tell=172 i'm=119 i'm_fairly=-70
    i'm_not=181 i'm_sure=-70 i'm_told=97 i've=131 i've_been=126 i've_got=5 i've_had=106
    i've_said=106 i_=176 i_always=157 i_am=200 i_believe=-141 i_can=94 i_can't=173 i_could=141
    i_did=103 i_do=26 i_don't=102 i_e=-155 i_er=-70 i_ever=103 i_got=91 i_guess=-85 i_had=161
    i_have=200 i_hear=-21 i_hope=77 i_know=44 i_left=-110 i_look=30 i_mean=-82 i_meant=-155
    i_need=65 i_never=53 i_repeat=-3 i_said=114 i_say=139 i_see=53 i_should=-39 i_still=103
    i_suppose=-84 i_take=147 i_tell=200 i_think=-84 i_thought=53 i_told=161 i_um=30 i_used=97
    i_want=20 i_was=171 i_would=22 i_write=176 iambic=113 ice=-173 ice_bucket=-85 ice_cream=-85
    ice_machine=-200 idea=28 identical=-29 identity=113 idk=-29 idle=84 if=151 if_a=147
    if_anyone=147 if_i=165 if_i'm=77 if_it=1 if_it's=80 if_the=88 if_they=200 if_you=132
    if_you're=107 ignore=107 ignore_the=62 ignored=-29 ignorethenextstep=113 ignoring=62
    ignroe=113 ii=-70 iii=-51 ikea=-110 ill=49 illegal=113 illuminated=-51 im=20 image=165
    images=113 imagine=116 imagine_that=136 immaterial=-29 immediate=156 immediate_effect=199
    immediately=-45 immediately_=28 immediately_after=-121 immediately_and=113
    immediately_left=-99 immediately_right=-99 immediately_to=-70 imminent=113 imperative=-29
    impersonate=113 importance=-29 important=199 impossible=113 in=19 in_=-18 in_a=-15
    in_again=-3 in_all=137 in_an=-121 in_and=-124 in_any=113 in_at=-174 in_between=-155
    in_by=-110 in_case=147 in_charge=196 in_closet=-174 in_desks=-70 in_each=136 in_front=-200
    in_go=113 in_here=-3 in_it=10 in_its=-70 in_my=140 in_one=43 in_order=-66 in_other=62
    in_our=200 in_place=200 in_question=-70 in_reverse=200 in_stop=-121 in_that=48 in_the=12
    in_there=-113 in_this=200 in_through=-91 in_turn=-34 in_two=-85 in_under=-85 in_view=-99
    in_wardrobe=-3 in_which=78 in_with=53 in_you=28 in_your=200 inch=176 incidents=-29
    inclination=-29 incline=-29 inclined=-29 including=200 inconvenience=-29 incorrect=113
    increased=113 indebted=-29 indeed=20 indefinitely=165 independent=113 indications=113
    indoor=-85 indoors=-51 infiltrate=-29 infinity=113 inform=-51 information=-130
    information_desk=-130 informed=-29 ingress=-29 inhibited=113 initial=62 initiate=-29
    injured=113 injury=49 inn=49 inner=-99 inner_door=-85 inning=-29 innocent=-29 input=176
    insane=49 insert=165 inside=-168 inside_=-200 inside_and=-185 inside_it=-70 inside_the=-92
    inside_then=-110 inside_through=-200 insist=-29 insists=-29 inspected=-29 inspector=113
    inspectors=113 install=113 installation=113 installed=113 instance=-29 instant=113
    instead=121 instead_=200 instead_and=-70 instead_of=71 instructed=-29 instruction=200
    instruction_=200 instruction_is=199 instructions=176 instrument=-29 intended=-70 intent=49
    interchanged=113 interest=84 interior=-51 intermediate=-51 internal=84 interpret=200
    intersection=-51 intersects=-29 intervals=-29 intervening=-29 interviews=49 into=-163
    into_a=-38 into_it=-99 into_the=-200 into_which=-70 into_your=103 intruder=113 invalid=113
    invented=113 invert=165 inverted=165 invisible=113 invite=-29 invited=-85 invited_to=-85
    inviting=-29 ipsum=113 iron=-79 iron_door=-130 iron_gate=-8 ironing=-131 ironing_board=-131
    is=82 is_=77 is_a=55 is_about=147 is_an=18 is_and=-99 is_asked=80 is_at=-48 is_behind=-131
    is_broken=200 is_by=15 is_called=54 is_cancelled=54 is_closed=110 is_customary=103
    is_done=136 is_down=136 is_entered=-121 is_essential=145 is_for=125 is_forbidden=199
    is_gone=-180 is_halted=-70 is_how=106 is_in=115 is_it=17 is_just=43 is_left=-23 is_made=-185
    is_my=21 is_named=200 is_next=-139 is_no=200 is_not=143 is_nothing=100 is_now=113 is_off=178
    is_on=-78 is_only=134 is_open=78 is_out=147 is_over=62 is_passed=-147 is_reached=-99
    is_requested=-67 is_required=62 is_respectfully=-70 is_right=113 is_stopped=-85
    is_taken=-110 is_that=117 is_the=12 is_then=-174 is_this=12 is_to=58 is_turned=-70
    is_used=62 is_void=191 is_walked=-147 is_what=139 is_where=-126 is_written=200 is_wrong=199
    is_you=-70 is_your=116 is_yours=-70 island=-168 island_=-158 island_and=-151 island_on=-130
    islanders=49 isle=-29 isn't=156 isn't_it=157 isnt=49 issue=165 issued=165 it=13 it'd=-29
    it'll=11 it'll_be=-70 it's=13 it's_a=56 it's_all=103 it's_dark=-85 it's_down=-36
    it's_er=-110 it's_for=-3 it's_forward=-85 it's_got=-41 it's_just=-36 it's_left=-72
    it's_like=-4 it's_not=33 it's_on=-50 it's_right=-139 it's_the=-60 it's_up=-85 it_=-7 it_a=67
    it_again=196 it_all=175 it_and=-141 it_as=-3 it_at=21 it_be=80 it_because=-70 it_behind=-70
    it_but=8 it_by=-147 it_comes=-70 it_curves=-121 it_does=-70 it_doesn't=147 it_down=-99
    it_ends=-34 it_for=200 it_gets=62 it_go=3 it_goes=22 it_has=112 it_he=-99 it_i=62 it_in=85
    it_into=-139 it_is=-29 it_isn't=30 it_looks=-82 it_may=153 it_not=-99 it_on=-92 it_once=53
    it_one=-50 it_opens=-130 it_out=-70 it_past=-70 it_right=28 it_says=200 it_should=62
    it_so=-36 it_stop=-82 it_stops=-85 it_tells=66 it_that's=-3 it_the=78 it_then=-85
    it_there's=-82 it_through=-110 it_to=-32 it_towards=-70 it_turn=-42 it_um=-3 it_until=-130
    it_up=62 it_walk=-70 it_was=163 it_will=136 it_with=55 it_would=86 it_yes=-70 it_you=-121
    it_you'll=-70 it_you're=-3 italian=113 italics=113 item=20 itinerary=165 its=-47
    its_door=-121 its_end=-200 its_far=-147 its_left=-200 its_near=-70 its_only=-85 its_other=43
    its_right=-200 its_tail=-70 itself=100 iv=-99 ivory=-51 jackets=-110 jackets_=-85
    jacuzzi=-200 jacuzzi_=-92 jacuzzi_and=-126 jacuzzis=-41 jailbreak=113 jars=-51 jazz=113
    jeez=49 jelly=49 jeweler=-51 jigsaws=-29 jinks=-29 jk=49 jkl=113 job=131 job_=176 job_is=43
    jobs=132 jog=-51 join=161 joining=49 joint=113 joke=170 journey=110 journey_ends=62 jst=-29
    judge=84 judge's=-70 judged=-29 judges=-29 jug=-51 juggles=-29 juice=43 jukebox=-89
    jukebox_=-110 jukebox_and=-110 juliet=49 jump=43 jumper=49 jumps=113 junction=-26 june=113
    jury=-85 jury_box=-85 jus=43 just=-38 just_a=-98 just_after=-110 just_before=-200
    just_follow=62 just_go=-32 just_in=-70 just_inside=-200 just_keep=-70 just_like=53
    just_outside=-200 just_past=-121 just_stop=-121 just_to=-36 just_turn=-70 just_wait=-110
    just_walk=-110 k=-36 karaoke=49 karate=49 karen=113 kayleigh=-29 keep=-56 keep_going=-84
    keep_it=62 keep_left=-147 keep_on=-168 keep_out=43 keep_right=-70 keep_straight=-70
    keep_the=-200 keep_to=-200 keep_turning=154 keep_walking=-76 keeper=49 keeper's=-70
    keeping=-200 keeping_it=-180 keeping_the=-130 keeping_them=-70 keeping_to=-110 keeps=-36
    kept=26 kettle=84 kevin=-29 key=147 keyboard=-36 keypad=-85 keypad_=-70 keys=78 keys_=62
    kick=-29 kicks=-29 kiddies=-29 kidding=84 kids=-29 kill=-121 killing=-51 kiln=-85 kilo=49
    kilometres=84 kind=75 kind_as=62 kind_of=33 kindly=-74 kindly_advance=-70 kindly_pass=-85
    kindly_proceed=-110 kindly_requested=-85 kindly_stop=-70 kindly_take=-70 kindly_turn=-161
    kindly_walk=-85 kindness=-29 kinds=113 king=28 king's=-29 king_size=-85 kings=113 kiosk=-85
    kisses=-29 kit=-146 kit_=-155 kit_and=-70 kitchen=-23 kitchen_=-86 kitchen_and=1
    kitchen_door=43 kitchen_doorway=-85 kitchen_is=78 kitchen_island=-137 kitchen_now=-110
    kitchen_past=-70 kitchen_sink=28 kitchen_table=-85 kitchen_through=-143 kitchen_with=-70
    kitchen_you=-155 kitchenette=-36 kitchens=199 kk=-29 klingon=113 knead=113 knee=53 knees=-29
    knew=49 knife=-51 knight=43 knight's=49 knitted=49 kno=49 knob=-99 knob_=-70 knock=135
    knocked=113 knocker=-51 knocks=-29 knot=-29 knots=-29 know=106 know_=118 know_it's=-3
    know_that=78 know_the=-3 know_what=55 know_you're=-3 known=165 knows=200 koi=-29 kx=113
    l=-48 l_=-130 la=-29 lab=-110 label=199 labelled=-110 laboratory=-29 labyrinth=113 lace=-51
    lack=113 lad=-29 ladder=-153 ladder_=-190 ladder_and=-48 ladder_into=-70 ladder_is=62
    ladder_on=-85 ladder_to=-121 ladders=-29 ladies=12 ladies_and=30 lads=49 lady=11 lady's=-29
    lady_with=-70 laid=-51 lake=80 lamp=-44 lamp_=-152 lamp_and=-104 lamp_on=-17 lamps=25
    lamps_=-26 lamps_and=62 landing=-188 landing_=-117 landing_and=-168 landing_turn=-147
    landing_with=-50 landings=-85 landlord=199 landlubber=113 landmark=162 landmark_is=136
    landmarks=178 lands=49 landscape=-51 lane=-21 lanes=-51 language=165 lantern=-62
    lantern_=-70 lanterns=-51 lap=-36 lapses=113 large=-191 large_staircase=-70 largest=-99
    laser=49 last=77 last_=200 last_chair=-85 last_door=-151 last_every=66 last_night=200
    last_of=-85 last_one=-26 last_room=-34 last_step=103 last_stool=-85 last_thing=-155
    last_time=-3 last_window=-70 last_year=161 lasts=113 lasts_=77 late=200 latency=113
    later=178 lateral=84 latest=113 lathe=-51 latin=-29 latter=-29 laugh=147 laughing=49
    laundry=-78 laundry_basket=-155 laundry_room=-67 lava=62 lavatory=-29 lavender=49 law=132
    lawful=113 lawn=-62 laws=-29 lawyer=113 lawyers=113 layman=-29 lays=-29 lazy=165 lead=41
    lead_you=15 leader=-29 leading=15 leads=-26 leads_to=43 leaf=-29 leaflet=49 leak=113
    leaking=113 lean=49 leaning=-29 leaning_on=-70 learn=20 learned=165 learning=49 least=200
    leather=-168 leather_armchair=-85 leather_chair=-105 leather_couch=-99 leave=-52 leave_=68
    leave_all=15 leave_by=-174 leave_it=37 leave_the=-134 leave_this=114 leave_through=-174
    leave_your=43 leaves=33 leaves_the=-85 leaving=-151 leaving_the=-190 lectern=-51 lecture=-3
    led=77 leeds=113 left=-140 left_=-176 left_90=-139 left_a=-85 left_across=-70
    left_after=-200 left_again=-200 left_along=-161 left_and=-200 left_arm=-85 left_around=-200
    left_as=-73 left_at=-200 left_before=-121 left_branch=-70 left_by=-80 left_corner=-72
    left_door=-70 left_down=-29 left_end=-70 left_enter=-116 left_for=56 left_go=-200
    left_halfway=-70 left_hall=-70 left_hand=1 left_i=-121 left_i'm=-85 left_immediately=-70
    left_in=-141 left_into=-177 left_is=29 left_it=62 left_just=-99 left_left=-21 left_my=-121
    left_not=-110 left_of=-170 left_on=-21 left_once=-94 left_one=-161 left_or=136 left_out=34
    left_pass=-70 left_past=-179 left_round=-36 left_side=-140 left_so=-106 left_staircase=-99
    left_stop=-29 left_that's=62 left_the=-155 left_then=-200 left_there=-200 left_through=-200
    left_to=-23 left_toward=-70 left_towards=-147 left_turn=75 left_until=-147 left_up=43
    left_walk=-121 left_wall=-130 left_when=28 left_where=-99 left_which=80 left_with=-26
    left_yes=-70 leftmost=-85 lefts=107 leftward=-29 leftwards=-29 leg=-125 legally=113
    legend=-29 lego=-110 legs=168 legs_=53 legs_and=43 leisurely=-29 lemon=-50 lemon_=-21
    length=-68 length_of=-16 length_past=-70 lens=113 lent=-29 leominster=49 less=95 let=156
    let's=36 let's_get=-110 let's_go=77 let's_start=28 let's_take=62 let_it=195 let_me=116
    let_the=113 letter=200 letter_of=199 letterbox=81 letterboxes=20 letters=3 level=-77
    level_and=-85 level_with=-85 liar=113 librarian=-29 library=-178 library_=-147
    library_and=-121 library_by=-70 library_then=-92 licence=113 licks=-29 lidar=113 lie=80
    lied=113 lies=193 lieu=-29 life=157 life_jackets=-110 lifeboat=-147 lifeboat_=-110
    lifeboats=-62 lifeboats_=-85 lifebuoy=-85 lifebuoy_=-85 lifeguard=-70 lifeguard's=-29
    lift=-6 lift_=-48 lifts=62 light=33 light_=-3 lighted=-29 lighthouse=-85 lighting=-51
    lights=46 like=82 like_=176 like_a=127 like_that=106 like_the=-82 like_to=56 like_you=34
    like_you're=-139 liked=113 likeness=-29 likes=165 likewise=-51 lily=-85 lily_pond=-85
    limb=-29 limit=84 limits=84 line=-38 line_=62 line_ends=-70 line_on=-155 lined=-51
    linen=-200 linen_cart=-70 linen_closet=-195 linen_cupboard=-85 lines=44 lintel=-29 linux=113
    lion=-110 lions=-29 lions_and=-70 lisbon=113 list=200 listen=91 listened=49 lit=-110
    literal=113 literally=-51 litter=113 little=-60 little_=-130 little_and=-110 little_bit=-85
    little_door=-82 little_hallway=-70 little_passage=-70 little_steps=-70 little_table=43
    little_to=-70 live=80 lives=132 livid=49 living=30 living_room=28 lizard=49 lmao=49 load=20
    loading=1 loading_bay=80 loading_dock=-110 lobby=-200 lobby's=-29 lobby_=-200 lobby_and=-200
    lobby_to=-85 lobby_with=-70 lobster=49 locate=-185 locate_a=-147 locate_the=-70 located=-70
    locating=-29 location=46 lock=165 locked=97 locker=-82 locker_room=-62 lockers=-200
    lockers_=-190 lockers_and=-161 locomotion=113 loft=-109 loft_=-139 loft_with=-70 log=113
    logbook=-51 login=-110 lol=167 lol_=136 lonely=165 long=-47 long_=-3 long_as=141
    long_hall=-130 long_hallway=15 long_low=-85 long_part=-70 long_side=-70 long_table=-105
    long_wooden=-70 longed=-29 longer=200 longue=-29 loo=-3 loo's=-29 look=-17 look_at=60
    look_down=-85 look_for=-98 look_to=-70 looked=-70 lookin=-29 looking=107 looking_at=31
    looking_for=167 looks=35 looks_like=81 loom=-51 loop=113 loose=84 lopez=113 lorem=113
    lose=200 lost=199 lost_=157 lot=6 lot_of=21 lots=-130 lots_of=-130 loud=178 loudspeakers=-29
    lounge=-55 lounge_=-180 lounge_and=-139 lounge_chair=-85 lounge_chairs=-110 lounge_go=-92
    lounger=-70 lounger_=-70 loungers=-113 loungers_=-121 louvred=-51 love=108 lovelier=113
    lovely=-73 loves=-29 low=57 low_doorway=-70 lower=-48 lower_deck=-99 lower_level=-70
    lowest=-70 ltd=113 luck=-3 lucky=-29 luggage=-110 lunch=-99 luv=-29 lying=176 m=-63 m_=-26
    m_and=-70 machine=-128 machine's=-29 machine_=-200 machine_and=-162 machine_in=-3
    machine_is=-85 machine_on=-98 machine_then=-126 machine_with=-70 machines=-83 machines_=-130
    machines_and=-121 machines_on=-12 madam=-29 made=5 made_=-70 made_and=-70 made_at=-85
    made_for=-70 made_it=103 made_of=-48 made_out=-70 mae=-29 magazine=-51 magazines=-110
    magazines_=-99 magic=49 magician's=49 magnets=113 magnificent=-29 magnitude=84 maid's=-51
    mail=-3 mail_room=-3 mailbox=-161 mailbox_=-139 mailboxes=-161 mailboxes_=-130 main=-147
    maintain=-29 maintenance=113 majesty=-29 make=-95 make_a=-200 make_for=-130 make_it=135
    make_your=-200 makeover=49 maker=15 makers=113 makes=91 makeup=-85 making=46 man=125
    man_on=103 man_with=106 management=200 manager=200 manager's=-85 managers=113 mannequin=-110
    mannequin_=-70 mannequins=-130 mannequins_=-121 manoeuvre=113 mansion=49 mantelpiece=-29
    manual=113 manufacturer=165 manuscripts=-51 many=78 map=138 map's=-29 map_=-26 map_is=136
    maps=49 marble=-183 marble_bust=-110 marble_columns=-85 marble_stairs=-110 marble_statue=-85
    marble_steps=-85 march=62 margin=113 mark=-85 marked=-147 market=-29 marks=-51 marquee=-51
    married=-29 marshal=165 marta=113 marvellous=132 masks=-51 massage=-141 massage_room=-85
    massage_table=-139 massages=-29 massive=-29 mast=-51 master=-144 master_bedroom=-193
    mat=-200 mat_=-200 match=103 matchday=49 matches=113 matching=-85 mate=-3 mats=-85
    matter=179 matter_of=136 maureen=49 may=169 may_be=-36 may_concern=103 may_not=176
    may_stop=43 maybe=54 mayor=30 maze=132 me=155 me_=120 me_a=106 me_and=113 me_for=106
    me_i=176 me_i'm=147 me_the=157 me_to=174 meadows=113 meal=20 mean=30 mean_the=-24 meaning=95
    means=141 means_left=199 means_of=-99 means_right=199 meant=111 meant_for=199 meant_the=-155
    measure=113 measured=132 measuring=-29 mechanic=113 meet=100 meeting=-61 meeting_room=-17
    meetings=-29 meets=-51 melted=113 members=-29 memo=49 memorial=-51 memories=132 memory=195
    mended=49 mention=176 mentioned=200 mentioned_=200 mentions=113 mercy=113 mere=-29 merely=-3
    merlin=113 merry=49 mess=-99 message=200 message_=199 message_from=200 messing=-29 met=-51
    metal=-200 metal_door=-85 metal_stairs=-155 metaphorically=113 meteor=84 meteorite=-70
    meter=-110 meters=-200 meters_=-85 meters_and=-110 metre=136 metres=129 mezzanine=-110
    mezzanine_=-70 microfilm=-36 microfilm_reader=-85 microphone=46 microphone_=-3
    microscope=-51 microscopes=-51 microwave=-193 microwave_=-182 microwave_and=-105
    microwaves=-41 mid=-29 middle=-87 middle_=-62 middle_aisle=-110 middle_and=-36
    middle_between=-85 middle_door=-85 middle_of=-88 middle_one=-85 midle=-29 midnight=113
    midpoint=-29 midst=-29 might=-141 might_be=-110 mighty=113 mile=49 miles=113 milk=95
    miller's=-110 million=103 mind=119 mind_=129 mind_the=56 mind_you=136 mine=-3 mine's=20
    mineral=-29 minerals=-70 mini=-51 minibar=-51 minimise=-29 minimum=-29 minister=113
    ministry=165 mint=-29 minus=173 minute=200 minute_=200 minutes=200 mirror=-87 mirror_=-200
    mirror_and=-61 mirror_at=-85 mirror_on=-85 mirror_so=-8 mirror_then=-121 mirror_with=-99
    mirrored=114 mirrored_=161 mirrored_wall=-85 mirrors=-61 mirrors_=-70 mirrors_on=-130
    misc=-110 misreading=-29 miss=101 misses=-29 missing=20 mission=105 mission_=136 mistake=113
    mistaken=53 mistakes=165 mister=20 mistletoe=-51 misunderstanding=49 mix=165 mixer=-3
    mixes=113 mmmmm=113 mobile=-70 mode=200 model=156 modest=-29 module=113 modulo=113
    moment=164 mondays=165 money=43 mongolia=113 monitors=-85 monkey=113 monoxide=113 month=132
    mood=-29 moon=165 moon's=113 moose=-3 mop=-8 mops=49 more=120 more_=185 more_step=28
    more_steps=3 more_than=157 morning=200 morning_and=176 mornings=-29 mortuary=49 mosaic=-51
    moscow=113 mosey=-85 most=15 mostly=-29 mother=76 mother's=-29 motion=193 motion_is=62
    motionless=165 motor=199 motors=113 mount=-51 mountains=-51 mounted=-99 mouse=49
    moustache=106 mouths=-29 move=50 move_=200 move_away=-200 move_forward=-130 move_toward=-200
    moved=170 moved_to=147 movement=200 moves=178 movie=-51 moving=116 moving_=167
    moving_walkway=-130 mr=113 mrs=113 ms=113 much=196 mud=-200 mud_room=-200 muddles=113
    muddling=-29 mudroom=-147 mudroom_=-70 mudroom_and=-70 muffled=49 multiply=113 mum=103
    mum's=-29 mummies=-85 mummy=-98 mummy's=-29 mummy_and=-99 mums=49 murder=49 muscle=113
    museum=83 museum_in=-70 music=-168 music_room=-155 must=200 must_be=78 must_go=181
    must_never=199 must_not=200 mustn't=113 mutual=113 my=160 my_brother=147 my_brother's=77
    my_cousin's=-3 my_eyes=147 my_friend=46 my_grandmother=147 my_late=106 my_left=136
    my_mother=49 my_old=180 my_own=-21 my_sister=147 myself=161 mystery=49 myths=113 n=-83
    n_go=15 n_stop=-174 n_the=-85 n_wait=-70 nag=-29 nah=165 nail=-51 name=147 named=200
    named_=200 named_in=199 nan=49 nan's=49 napoleon=113 narrator=165 narrow=-198
    narrow_door=-50 narrow_hallway=-99 narrow_passage=-70 narrow_stairs=-99 narrower=-51
    nation's=49 national=113 natural=113 naturally=-51 nave=-99 navigation=200 nb=49 nd=44
    near=-20 near_a=147 near_end=62 near_it=28 near_the=-82 nearer=20 nearest=-42
    nearest_bed=-110 nearest_couch=-99 nearest_mirror=15 nearest_the=-72 nearest_to=-50
    nearest_toilet=-185 nearly=-29 neat=-29 necessary=84 neck=84 need=74 need_a=26 need_is=-42
    need_not=170 need_to=41 needed=-51 needn't=103 needs=144 negate=113 negated=113 negative=113
    neighbor=-29 neighbor's=49 neighborhood=-29 neighbour=165 neighbour's=165 neighbours=113
    neither=179 nemo=-29 neon=-70 nephew=20 nerves=49 net=53 never=200 never_been=176
    never_go=199 never_mind=142 new=200 newel=-70 newel_post=-70 news=196 newsletter=113
    newspaper=-110 newspaper_rack=-110 newspapers=-85 newspapers_=-70 newsstand=-51 next=-98
    next_=159 next_door=-200 next_left=-78 next_one=51 next_room=-168 next_sentence=199
    next_to=-200 next_turn=136 nice=11 nice_=53 nicely=-29 nicer=176 niche=-51 night=200
    night_=200 nightmare=49 nightstand=-200 nightstand_=-135 nightstand_with=-85 nil=106
    nine=181 nineteen=49 ninety=-136 ninety_degree=-70 ninety_degrees=-130 nip=-51 no=140
    no_=157 no_don't=103 no_further=-34 no_goal=199 no_good=77 no_longer=200 no_matter=136
    no_more=11 no_need=200 no_not=30 no_stairs=-3 no_wait=103 nobody=200 nobody's=81
    nobody_goes=136 noclip=113 noise=113 noises=113 nomenclature=49 nominal=-29 none=200
    none_=136 none_of=200 nonsense=165 nook=-200 nook_=-182 nook_and=-147 nook_then=-85
    nook_with=-78 noon=165 nor=20 normal=80 north=54 northbound=-29 nose=-70 not=98 not_a=159
    not_allow=134 not_asking=106 not_at=62 not_be=193 not_climb=62 not_do=200 not_enter=99
    not_follow=170 not_for=-85 not_go=31 not_going=-3 not_i=-3 not_in=3 not_left=-85
    not_mentioned=199 not_move=200 not_on=-85 not_pass=3 not_right=-70 not_stop=31 not_take=64
    not_that=11 not_the=-75 not_through=-130 not_to=50 not_too=43 not_turn=134 not_up=-4
    not_use=68 not_walk=200 not_where=30 not_yet=106 note=185 noted=49 notes=49 notgo=113
    nothing=165 nothing_=200 nothing_about=199 nothing_else=54 nothing_in=78 nothing_on=15
    nothing_to=170 notice=151 notice_a=20 notice_board=-85 notice_the=156 notice_your=94
    noticeboard=-21 noticed=-29 notices=-29 noting=-29 notion=49 notturn=113 nouns=113 novel=113
    november=-29 novice=49 now=54 now_=200 now_and=129 now_go=-110 now_he=-70 now_i=-70
    now_in=-147 now_on=200 now_so=-72 now_take=62 now_the=-21 now_there=62 now_turn=-130
    now_walk=-110 now_you=-131 now_you're=-147 nowhere=84 null=165 nulling=-29 number=112
    number_of=170 number_three=-85 numbered=113 numbers=84 numerous=-29 nurse=147 nurse's=-139
    nursery=-200 nursery_=-200 nursery_and=-171 nursery_on=-85 nursery_then=-110
    nursery_with=-85 nurses=-168 nurses_station=-139 nuts=113 nutshell=49 nxt=-70 o=3
    o'clock=-161 o'clock_and=-70 oak=49 oak_door=-3 obey=200 obeyed=183 obeyed_=172 obeying=113
    object=200 objective=43 objects=113 obliged=-29 oblique=-51 observation=-3 observatory=-29
    observe=-70 observed=-29 obsolete=132 obstacle=-51 obstacles=-29 obvious=-29 obviously=-51
    occupies=-29 occurs=136 ocean=-70 oche=-29 octagonal=-51 odd=200 odds=-29 ode=113
    odometer=113 of=-34 of_=-139 of_3=-70 of_90=-85 of_a=-3 of_all=104 of_an=76 of_apples=-70
    of_armor=-168 of_automatic=-70 of_bed=62 of_beds=-70 of_black=-85 of_books=-85
    of_candles=-70 of_chairs=-61 of_computers=-70 of_course=-21 of_date=199 of_doors=-42
    of_drawers=-99 of_each=200 of_every=167 of_feet=-200 of_flags=-85 of_flowers=-70
    of_glass=-99 of_going=15 of_green=-85 of_head=20 of_it=-104 of_management=106 of_my=77
    of_ninety=-70 of_one=-110 of_room=-70 of_seats=-147 of_shelves=-70 of_stairs=-200
    of_steps=-121 of_stone=-85 of_tables=-70 of_that=74 of_the=-85 of_them=-97 of_these=146
    of_thing=53 of_this=200 of_those=8 of_three=-85 of_two=-110 of_us=103 of_what=200
    of_which=-121 of_white=-121 of_windows=-121 of_wine=-99 of_you=-168 of_your=138 off=102
    off_=200 off_by=62 off_from=-70 off_it=43 off_the=-1 off_to=66 offer=-51 offered=-29
    office=-72 office_=-150 office_and=-200 office_does=66 office_has=103 office_on=62
    office_turn=-99 office_with=-105 officer=196 official=165 officially=113 offline=165
    offset=-29 often=132 oh=107 oi=49 oil=125 ok=190 ok_=200 okay=-24 okay_=135 okay_so=-29
    okey=-29 old=148 old_man=-70 old_place=106 older=-29 oldest=-51 olives=113 ollie=-29 omg=132
    on=-78 on_=7 on_a=-38 on_all=103 on_and=31 on_both=-139 on_by=-70 on_down=-85 on_for=62
    on_going=-99 on_her=55 on_it=-148 on_its=-200 on_left=-110 on_my=21 on_one=-99 on_out=-70
    on_past=-185 on_reaching=-70 on_right=-130 on_straight=-85 on_that=62 on_the=-109
    on_them=-121 on_this=59 on_through=-110 on_to=-200 on_top=28 on_treat=132 on_until=3
    on_up=-85 on_ur=-155 on_wheels=28 on_you=173 on_your=-200 once=38 once_=200 once_and=88
    once_every=94 once_inside=-110 once_more=-15 once_so=66 once_the=-99 once_there=-70
    once_through=-3 once_you=-150 once_you're=-110 once_you've=80 one=-18 one's=-49 one_=-33
    one_after=80 one_and=-107 one_at=74 one_by=-17 one_day=-3 one_deck=-110 one_door=-85
    one_end=-85 one_flight=-190 one_floor=-80 one_foot=-70 one_go=-130 one_goes=-70 one_has=-70
    one_hundred=-70 one_in=-147 one_is=-63 one_level=-99 one_more=46 one_next=-70 one_not=-17
    one_of=30 one_on=-97 one_room=199 one_should=-155 one_side=-26 one_so=136 one_step=-66
    one_that=-14 one_that's=-70 one_to=26 one_too=62 one_turns=-70 one_two=-17 one_up=-99
    one_who=170 one_with=-117 one_you=-72 ones=46 ones_=66 ones_are=62 oneself=-70 onions=113
    online=113 only=144 only_=200 only_a=193 only_and=103 only_door=-85 only_half=136
    only_if=199 only_one=-72 only_the=134 onto=-200 onto_the=-200 onwards=113 ooh=12 oops=-121
    open=-93 open_=26 open_and=46 open_door=-200 open_doors=43 open_doorway=-161 open_it=-72
    open_the=-48 opened=-70 opening=-148 opening_=-21 opening_and=-85 opening_in=-121
    opening_into=-85 opening_on=-168 opens=-26 opens_on=43 opera=-29 operational=113
    operator=200 operator's=165 operator_has=66 operators=113 opinion=113 opposed=-70
    opposed_to=-70 opposite=72 opposite_=66 opposite_day=200 opposite_direction=-110
    opposite_of=200 opposite_side=28 opposite_the=-174 optical=-29 optician=-51 optional=113
    options=-29 or=84 or_a=147 or_down=3 or_not=103 or_right=62 or_the=-99 or_what=-85
    or_you=-70 oracle=113 orange=-102 orange_canvas=-3 oranges=-51 orchid=-51 orchids=-29
    order=200 order_=200 order_of=200 order_to=-121 ordered=113 ordering=49 orderly=-29
    orders=200 orders_=200 orders_so=81 orders_you=81 organ=-174 organ_=-139 organ_pipes=-85
    orient=-29 oriental=-29 orientation=-29 origin=-29 original=113 originate=-29 orphan=113
    oslo=113 other=36 other_=93 other_and=-70 other_end=-96 other_hand=197 other_one=-121
    other_side=-81 other_way=153 others=195 otherwise=200 otters=113 ottoman=-200 ottoman_=-174
    ought=55 ought_to=55 our=180 ours=-51 out=-71 out_=50 out_and=-185 out_at=-99 out_by=-136
    out_from=-85 out_in=15 out_into=-48 out_it=62 out_left=-82 out_of=-163 out_on=-147
    out_onto=-200 out_past=-70 out_so=-70 out_the=-1 out_there=-130 out_through=-121 out_to=-195
    out_turn=-121 outdoor=-110 outdoors=84 outer=-29 outeray=113 outline=113 output=176
    outrank=113 outside=-173 outside_=-115 outside_and=-52 outside_it=-139 outside_of=-147
    outside_on=-110 outside_room=-110 outside_the=-200 outside_then=-126 outside_through=-99
    outside_to=-70 outvoted=49 oval=-200 oval_mirror=-78 oven=-101 oven's=113 oven_=-200
    oven_and=-86 oven_on=-99 ovens=113 over=5 over_=80 over_and=80 over_by=77 over_it=12
    over_the=-77 over_there=103 over_to=-104 over_your=136 overheating=113 overlooking=-29
    overlooks=-51 override=134 overview=49 overwrite=165 ovr=-29 owe=113 owes=49 owing=-29
    own=192 own_axis=174 owner=200 owner's=-85 owner_has=132 owner_of=200 pace=113 paces=-70
    packed=132 packet=113 packets=113 page=200 pagoda=-51 paint=30 paint_cans=-85 painted=60
    painted_on=62 painting=-153 painting_=-165 painting_and=-105 painting_of=-130 paintings=-195
    paintings_=-161 paintings_on=-70 pair=-180 pair_of=-161 pairs=-29 pajamas=-29 pal=-3
    pale=-29 pallet=-51 pallets=-99 pallets_=-70 palm=-168 palm_=-110 palms=-3 pane=-29
    paned=-51 panel=-185 panel_of=-130 panic=49 pantry=-83 pantry's=49 pantry_=-28
    pantry_and=-143 pantry_door=-82 pantry_with=-78 pants=49 papa=49 paper=37 paper_=-70
    papered=-29 papers=-29 par=-85 paragraph=199 parallel=-51 parameters=113 parasol=-51
    parcel=113 parentheses=113 parish=-29 park=-17 parked=-72 parking=-85 parking_lot=-70
    parks=-29 parlor=-3 parlour=-29 parquet=-36 parrot=49 parser=113 part=181 part_about=199
    part_of=153 parted=49 parts=49 party=84 pass=-177 pass_2=-135 pass_a=-104 pass_beneath=-85
    pass_between=-99 pass_by=-70 pass_four=-139 pass_it=-26 pass_on=-70 pass_one=-85
    pass_something=106 pass_the=-200 pass_three=-147 pass_through=-155 pass_to=-139
    pass_two=-198 pass_under=-70 passage=-156 passage_=-99 passage_and=-85 passage_past=-70
    passage_to=-110 passed=-36 passed_=-99 passed_and=-110 passed_by=136 passed_the=-85
    passed_through=-99 passengers=-29 passes=-130 passing=-195 passing_the=-130 past=-200
    past_=-17 past_a=-151 past_all=-200 past_and=-70 past_both=-121 past_every=-155
    past_five=-21 past_four=-99 past_it=-158 past_one=-70 past_six=28 past_that=-110
    past_the=-200 past_them=-155 past_three=-161 past_two=-185 pat=-29 patch=-29 patched=-29
    path=-36 path_=-85 path_is=-110 path_that=28 patience=176 patio=-200 patio_=-177
    patio_and=-198 patio_door=-99 patio_turn=-85 patrol=20 pause=10 pause_at=-121 pausing=-29
    pavilion=-50 pavilion_=-3 pay=25 pay_phone=-85 pea=-29 peanuts=-51 pears=-29 peasy=-29
    pebbles=-29 pedestal=-85 pedestal_=-85 pee=-29 peek=-51 peel=-51 peels=-29 pegboard=-51
    pegs=-110 pen=125 penalty=-29 pencil=113 penguin=-36 penguin_=-3 pentameter=113 people=65
    people's=113 people_=147 people_put=-3 people_sitting=-139 per=113 perceive=-51 percent=200
    perches=113 perfect=-51 perfectly=103 perform=113 perform_a=62 perfume=-51 pergola=-51
    perhaps=117 perimeter=113 permission=113 permit=95 permits=113 permitted=136
    permitted_to=136 permute=113 perpendicular=-29 persian=-51 person=200 person's=113
    person_in=161 person_who=139 persona=113 personnel=113 pet=49 petal=-29 pete=49 peter=113
    petting=49 pew=-168 pew_=-99 pews=-160 pews_=-85 pews_and=-85 pews_on=-85 pews_to=-70
    phase=-130 philosopher=113 philosophers=-21 phone=-146 phone's=49 phone_=-50 phone_booth=-99
    phones=20 photo=-30 photo_booth=-82 photo_of=62 photocopier=-29 photograph=113
    photographer's=-29 photographers=-51 photographs=-85 photographs_and=-70 photos=-110
    photos_on=-85 physical=-29 piano=-93 piano_=-131 piano_and=-22 piano_in=-3 piano_on=-12
    piano_then=-85 pianos=-105 pic=49 pick=151 pick_the=43 picks=20 picnic=-51 picture=-35
    picture_=-45 picture_a=-70 picture_and=-85 picture_of=-34 pictures=91 pictures_on=62
    piece=46 piece_of=80 pieces=-29 pigeonholes=-51 pile=-29 pillar=-200 pillar_=-195
    pillar_and=-147 pillars=-165 pillars_and=-99 pillows=62 pinball=-85 pinball_machine=-85
    pinch=103 pineapple=-21 ping=-34 ping_pong=-147 pink=-200 pins=-29 pipe=62 pipes=-130
    pirate=113 pit=21 pitch=-29 pity=165 pivot=62 pizza=132 place=170 place_=134 place_at=-24
    place_is=176 place_to=43 place_where=154 placed=33 placeholders=113 places=147 plaid=-29
    plain=-51 plainer=49 plan=200 plan_=199 plane=-70 planetarium=-3 planets=-51 plank=-3
    planned=113 planner=113 plant=-59 plant_=-140 plant_and=-200 plant_in=28 plant_is=136
    plant_on=-43 plant_take=-92 plant_turn=-135 planted=-29 planter=-51 planters=-51 plants=54
    plaque=-130 plaques=-29 plaster=-29 plastic=33 plate=84 plates=-110 platform=-106
    platform_=-99 play=134 player=-139 player_=-110 playhouse=-29 playing=-51 playroom=-147
    plays=165 please=88 please_=24 please_be=28 please_conclude=-70 please_continue=-70
    please_do=174 please_don't=147 please_enter=-70 please_exit=-85 please_leave=-110
    please_proceed=-168 please_return=140 please_stop=-99 please_take=-58 please_turn=-147
    please_walk=-72 pleases=113 pleasure=-29 plinth=-29 plonk=-51 plotter=-51 pls=66 plug=113
    plumbed=-29 plumber=81 plunge=-168 plunge_pool=-161 plus=-29 plush=-29 plz=-51 po's=-110
    pocket=84 podium=-85 poet=113 point=75 point_=88 pointed=-51 pointer=113 pointing=20
    points=78 pointy=-29 poisoned=113 poke=-29 polarity=113 pole=-70 poles=-29 police=200
    policy=113 polish=43 pommel=-51 pond=-98 pond_=-50 pong=-147 pong_table=-147 pool=-183
    pool_=-67 pool_and=-190 pool_on=-99 pool_table=-200 pool_to=-70 pool_with=-99 poor=157
    pop=15 popcorn=-180 popcorn_stand=-99 poppet=-29 pops=113 porcelain=-51 porch=-200
    porch_=-172 porch_and=-143 porch_swing=-70 porches=113 port=-51 portable=-29 porter=49
    porthole=-110 porthole_=-85 portholes=-130 portrait=-200 portrait_=-85 portrait_of=-85
    portraits=-51 portside=-29 portuguese=113 pose=62 posh=49 position=54 position_is=62
    positioned=-29 positive=84 possessing=-29 possible=-51 possibly=-36 post=83 post_=43
    postcard=49 postcards=-51 postcondition=-29 poster=-26 poster_bed=-70 posters=-110
    posters_=-85 posts=-70 pot=-72 pot_=-70 pot_and=-3 pots=15 pots_hanging=-70 potted=-200
    potted_fern=-85 potted_palm=-155 potted_plant=-200 potted_tree=-99 pottery=-82 potting=-51
    pouffe=-29 poultry=-29 pour=-29 pouring=132 powder=-51 power=103 powered=113 practically=-29
    prams=-29 prankster=113 prayer=-51 praying=-29 precedence=113 preceding=113
    preconditions=-29 prefer=113 preferable=-29 preferred=-29 preheat=113 premises=49 prep=-29
    presence=-29 present=159 presently=62 presents=-51 president=113 press=-3 pressed=113
    pressure=62 presume=49 pretend=200 prettier=113 prettiest=49 pretty=-34 previous=200
    previously=49 price=113 prime=113 principal=-29 principal's=-51 principle=113 print=173
    printed=199 printer=-180 printer_=-110 printer_and=-99 printers=-51 prior=-8 prior_to=-8
    priority=103 privacy=113 private=-110 privilege=49 privileges=113 prize=84 probably=-3
    proceed=-175 proceed_along=-139 proceed_between=-99 proceed_down=-70 proceed_from=-70
    proceed_past=-200 proceed_through=-147 proceed_to=-139 proceeded=-29 produce=-51 progress=-3
    projected=113 projection=-29 projector=-21 projectors=-51 projects=-29 promenade=-99
    promenade_deck=-85 promise=49 promoted=113 prompt=199 pronto=-29 proof=-51 proper=-50
    properly=81 proportions=-29 proposed=49 propped=-29 proud=80 prove=113 proved=113
    provided=113 prudent=-29 psst=113 pt=49 pub=84 pucker=-29 pull=84 pulled=-29 pulling=-29
    pulpit=-127 pulpit_=-147 pulpit_and=-99 pump=-85 punching=-85 punching_bag=-85
    punctuation=113 punished=113 pup's=-29 pupils=49 puppet=-85 puppet_theater=-70 pure=49
    purple=-200 purple_one=-70 purpose=84 purposes=165 purser=49 purser's=-51 pursuant=113
    push=-61 pushed=-29 pushes=62 put=144 put_=200 put_it=80 put_on=-3 put_this=103 puts=43
    putting=-51 pyjamas=-29 pyramid=-51 q=-51 qty=-29 quality=113 quantum=113 quarantine=113
    quarter=-21 quarters=-3 query=-29 question=66 questions=118 queue=103 quick=46 quickly=-99
    quiet=-130 quietly=-70 quilt=-51 quilts=-29 quit=136 quite=-3 quits=113 quotation=113
    quote=165 quoted=113 quotes=113 quoting=113 qwerty=113 r=41 rabies=113 race=-29 racing=-29
    rack=-200 rack_=-200 rack_and=-200 rack_is=-85 rack_of=-130 rack_on=-110 rack_turn=-85
    rack_with=-85 racks=-94 racks_=-70 racks_of=-36 radiator=-93 radiator_=-121 radiator_and=-70
    radiators=-110 radio=81 radioactive=113 rail=-119 railing=-200 railing_=-168
    railing_and=-182 railing_on=-136 railing_to=-121 railings=-85 rails=-70 railway=49 rain=-17
    rain_barrel=-70 rainbow=-29 raining=-29 raked=-29 rally=49 ramble=49 ramp=-200 ramp_=-200
    ramp_and=-146 ramp_not=-70 ramp_on=-70 random=165 range=43 rate=49 rates=113 rather=111
    rather_than=193 rational=113 rattle=-29 rattles=49 raw=49 ray=-3 rd=-51 reach=-121
    reach_a=-85 reach_it=-110 reach_the=-145 reached=99 reached_=15 reached_the=139 reaches=-29
    reaching=-139 reaching_it=-99 reaching_the=-70 read=200 read_is=154 read_the=159
    read_this=200 readable=49 reader=66 reading=75 reading_room=-36 reads=76 ready=30 real=133
    realised=49 really=123 rear=-26 rear_door=-70 rearward=-29 rearwards=-29 reason=199
    reasonably=-29 reasons=113 reboot=113 rebuilt=113 recall=136 recap=49 recapitulate=49
    recapitulation=49 receipt=-29 receive=165 received=176 reception=-200 reception_=-126
    reception_counter=-85 reception_desk=-200 recessed=-29 recharge=113 recipe=-29
    reciprocal=-29 recite=113 reckon=-29 reclassified=113 recliner=-36 recliners=-51
    recognise=113 recollect=-29 recommend=-29 recommendation=-29 recon=49 record=3
    record_player=-110 recorded=113 recovered=49 recruit=49 recycling=-3 red=-97 red_and=-70
    red_carpet=-174 red_couch=-105 red_curtain=-139 red_door=-58 red_fire=-70 red_fridge=-70
    red_line=-70 red_sofa=-36 redirect=113 reduce=-29 ref=-29 reference=-29 reflection=113
    reflective=-70 refrain=80 refrain_from=80 refreshment=-29 refrigerator=-99
    refrigerator_=-124 refrigerator_and=-85 refrigerator_on=-78 refrigerator_turn=-92
    refrigerators=-29 refuse=199 refused=113 refuses=165 regard=-70 regard_to=-70 regarded=165
    regardless=113 register=-200 register_=-147 regret=165 regular=-51 regulation=113 reined=-29
    reinstate=113 reject=165 relaid=-29 related=49 relax=136 relax_=136 relaying=49 release=84
    released=165 relief=49 relieved=-51 relocate=-29 relocation=81 rely=113 remain=138
    remain_=43 remain_at=147 remainder=195 remainder_of=170 remaining=100 remaining_steps=15
    remains=43 remark=49 remarkable=49 remember=154 remember_to=161 remembered=113 remind=84
    reminds=49 remove=170 removed=165 renamed=165 renovation=113 renumbered=113 repair=84
    repairs=-29 repeat=173 repeated=84 replace=200 replace_the=199 replaced=199 replacement=113
    replaces=113 reply=132 report=200 report_that=199 reported=132 reporter=84 repose=-29
    request=151 request_=199 request_that=-70 requested=-130 requested_that=-200
    requested_to=-161 requesting=-29 requests=113 require=-29 required=46 requirement=-29
    requires=170 reroute=113 rescinded=113 research=113 reserved=113 reservoir=49 reset=113
    residence=49 residents=-29 resigned=113 resist=113 resorted=-29 respect=84 respectfully=-62
    respond=113 rest=156 rest_=129 rest_is=170 rest_of=159 restaurant=-110 restaurant_and=-70
    resting=-29 restrictions=113 restroom=-70 restrooms=-99 restrooms_=-70 result=-51
    results=147 retrace=56 retrace_your=-4 return=200 return_to=200 returned=113 returns=80
    reverse=155 reverse_of=200 reversed=113 revert=113 review=49 revoked=165 revolution=-29
    revolvin=-29 revolving=-200 revolving_door=-174 revolving_doors=-99 reward=113 rewarded=84
    rewinding=113 rewrite=113 rhyme=113 ridden=-29 ride=-99 riding=-29 right=-144 right's=-29
    right_=-155 right_90=-99 right_a=-110 right_after=-200 right_again=-200 right_along=-130
    right_and=-200 right_angle=-70 right_are=43 right_around=-200 right_as=-62 right_at=-200
    right_because=-70 right_before=-113 right_beside=62 right_by=-174 right_corner=-139
    right_cross=-92 right_down=-99 right_from=-24 right_go=-200 right_hand=-67 right_i=36
    right_i'd=-99 right_immediately=-85 right_in=-44 right_instead=15 right_into=-200
    right_is=-1 right_just=-174 right_like=62 right_n=-85 right_not=-99 right_now=-110
    right_of=-168 right_off=-85 right_on=-121 right_one=-61 right_out=-99 right_past=-193
    right_place=-110 right_right=37 right_round=-21 right_side=-200 right_so=-54 right_stop=-110
    right_take=-70 right_that=-70 right_that's=62 right_the=-110 right_then=-200
    right_there=-153 right_through=-85 right_to=18 right_towards=-168 right_turn=-91
    right_until=-42 right_up=-139 right_wait=-139 right_walk=-188 right_wall=-110 right_when=-8
    right_where=80 right_which=-70 right_with=-72 right_you=-21 rightly=20 righto=-29 rights=173
    rightward=-51 rightwards=-29 righty=-29 rihgt=84 rim=-29 ring=117 rings=113 rink=-29
    riser=-29 risers=-29 rises=-29 risky=-29 rite=-110 river=165 riverside=-161 rm=-15 rm_=-85
    rms=-29 road=62 roads=113 robes=-51 robot=161 robot_=85 robot_in=176 robot_is=80
    robot_to=136 robotics=113 robots=200 robots_=54 robots_must=199 rock=80 rocket=-51
    rocking=-200 rocking_chair=-174 rocking_horse=-155 rocks=-85 rofl=113 roger=49 role=199
    roll=91 rolled=-8 rolled_up=-99 roller=-85 roller's=-29 rollers=-29 rolling=62 rolls=-70
    roman=-51 rome=113 romeo=49 roof=53 roof_=-99 roof_terrace=-3 room=-71 room's=-51 room_=-87
    room_214=-99 room_after=-54 room_and=-200 room_at=-70 room_before=119 room_between=-70
    room_by=-155 room_door=-110 room_for=91 room_go=-174 room_has=1 room_in=66 room_is=106
    room_on=-88 room_opposite=-130 room_past=-70 room_stop=-85 room_straight=-99 room_that=114
    room_that's=-70 room_the=-17 room_then=-200 room_through=-177 room_to=12 room_turn=-200
    room_using=-200 room_walk=-34 room_where=-139 room_which=-99 room_with=-169 room_you=31
    roomates=-29 rooms=115 rooms_=163 rooms_on=28 root=199 roots=113 rope=-106 rope_=28
    rope_barrier=-130 rope_ladder=-85 ropes=-50 ropes_=-85 rose=-85 roses=113 rot=113 rotate=78
    rotate_twice=116 rotates=-29 rotating=113 rotation=28 roughly=-51 round=-30 round_=200
    round_and=-0 round_bench=-78 round_dining=-70 round_it=-82 round_one=-36 round_table=-130
    round_tables=-85 round_the=-129 round_to=-121 round_window=-62 rounded=-29 rounding=-29
    route=200 route_=200 route_and=200 route_is=200 routes=165 row=-200 row_=-155 row_and=-121
    row_of=-200 row_six=-85 rower's=-29 rowing=-130 rowing_machine=-110 rows=-185 rows_of=-161
    rt=-29 rubber=28 rubbish=80 rude=113 rug=-132 rug_=-152 rug_and=-54 rug_ends=-85 rug_in=-82
    rug_is=-70 rug_to=-78 ruin=113 rule=170 rules=200 rules_=199 rum=113 rumbling=49 rumour=113
    run=198 run_lasts=142 run_out=-70 runner=-155 runner_rug=-85 running=-70 runny=113 runs=-121
    ruote=113 rush=103 rusty=-29 s=-29 sacristy=49 sad=113 saddle=-121 saddle_=-70 saddles=-51
    safe=-8 safely=-29 safest=113 safety=200 safety_officer=106 said=198 said_=62 said_that=199
    said_the=147 said_to=125 sailor=20 salad=-110 salad_bar=-85 sale=62 salon=-110 saloon=-85
    salt=62 same=91 sample=113 sandbox=-70 sandra=53 sandwich=20 sanitary=-29 satisfaction=-29
    saturn=-51 sauna=-200 sauna_=-188 sauna_and=-143 sauna_go=-78 sausage=-29 save=113 saved=49
    saw=103 sawn=49 say=132 say_=200 say_and=62 say_hi=-21 say_it=200 say_right=-3 say_that=200
    say_the=-21 saying=141 says=199 says_=200 says_left=200 says_so=103 says_stop=-42
    says_that=200 says_to=170 says_you=199 scale=-200 scale_=-161 scales=-99 scales_=-70
    scary=20 scavenger=147 scavenger_hunt=147 scenic=113 school=21 schoolroom=-29 schuss=-29
    science=80 scissors=113 sconces=-51 scoot=-70 score=49 scoreboard=-70 scoreboard_=-70
    scored=49 scrap=200 scraper=-51 scrapyard=113 scratch=113 scream=-29 screaming=113
    screen=-200 screen_=-200 screen_door=-139 screens=-147 scroll=-110 scullery=-110
    sculpture=-200 sculpture_=-168 sculpture_and=-110 sculptures=-41 sd=113 sea=145 sea_=199
    sea_on=-3 seafood=-51 sealed=165 search=164 search_for=43 search_the=136 seashells=-36
    season=49 seat=-115 seat_=-98 seat_on=-70 seat_with=-70 seated=43 seating=-51 seats=-141
    seats_=-72 sec=-51 second=-98 second_=-58 second_at=43 second_bedroom=-99 second_bench=-85
    second_classroom=-70 second_door=-79 second_doorway=-85 second_floor=-130 second_left=-99
    second_lifeboat=-70 second_lounger=-70 second_of=-85 second_on=-70 second_one=-185
    second_opening=-36 second_right=-155 second_row=-85 second_set=3 second_teller=-85
    second_to=-3 second_turn=62 second_window=-139 secondly=-29 seconds=200 secret=200
    secretary's=-51 secs=49 section=80 sectional=-70 sector=-29 secure=-70 security=99
    security_desk=-17 see=-61 see_a=-111 see_an=-177 see_if=-21 see_is=199 see_stairs=-70
    see_that=1 see_the=-179 see_two=-85 see_you=118 see_yourself=-70 seedling=49 seeing=84
    seek=103 seeks=113 seem=-51 seen=132 seen_a=103 seen_from=136 sees=-3 segment=-51 select=15
    select_the=-85 self=132 sell=132 sells=-29 send=200 send_you=199 sendorfer=-110 senior=113
    sense=147 sensible=49 sensor=170 sensors=113 sent=200 sentence=200 sentence_about=199
    sentence_is=200 sentences=199 sentry=49 separated=-29 separating=-29 separation=-29
    sequence=84 serial=113 serious=49 seriously=165 servants=-70 serve=113 served=132 server=80
    serves=-70 service=68 service_=136 service_stairs=62 serving=20 session=165 set=5 set's=-29
    set_=-99 set_of=-200 sets=-139 sets_of=-139 settee=28 settings=113 settled=-29 settles=-29
    seven=154 seven_=-3 seven_and=147 seventeen=113 seventh=-51 severely=113 sewing=-174
    sewing_machine=-155 sewing_room=-85 shade=-70 shade_=-70 shaggy=-51 shake=-29 shall=125
    shall_be=80 shall_i=106 shall_then=-70 shallow=-51 shan't=49 shape=20 shaped=-17
    shaped_like=28 shapes=49 shared=-29 shares=113 sharp=-170 sharp_left=-200 sharp_right=-200
    sharp_turn=-70 sharply=-99 sharply_right=-70 shatter=113 she=13 she'd=49 she's=-33
    she's_gone=-70 she_does=62 she_goes=-85 shed=11 shed_=15 sheep=113 sheets=12 sheets_on=-3
    shelf=-200 shelf_=-116 shelf_and=-174 shelf_of=-110 shelf_with=-85 shells=-29 shelter=132
    shelves=-200 shelves_=-110 shelves_and=-85 shelves_with=-85 shelving=-85 shelving_units=-70
    shh=-51 shhh=-51 shift=107 shine=-51 shiny=-147 shiny_black=-70 shiny_floor=-85 ship=-24
    ship's=-70 ship_=-21 shipping=132 shirt=113 shoe=-200 shoe_bench=-85 shoe_counter=-85
    shoe_display=-110 shoe_rack=-121 shoe_shop=-99 shoe_store=-99 shoes=-82 shoes_=-99
    shooting=-29 shoots=-29 shop=-71 shop_=-106 shop_and=-62 shop_door=-85 shop_past=-85
    shop_turn=-70 shop_windows=-85 shopping=-85 shopping_carts=-85 short=-11 short_of=-62
    shorter=49 shortest=113 shortly=20 shot=-29 shots=113 should=27 should_be=-30 should_go=199
    should_not=195 should_now=-110 should_see=-200 should_stop=-34 should_think=-70
    should_turn=80 should_you=147 shoulder=113 shouldn't=20 shout=84 shouted=165 shouts=113
    shove=-29 show=167 show_me=103 showdown=49 showed=113 shower=-155 shower_=-30
    shower_and=-126 shower_room=-147 shower_turn=-85 showers=-23 showers_=-70 showers_and=-85
    shown=132 shows=136 shredder=-85 shuffleboard=-51 shuffled=113 shush=49 shut=155
    shut_down=200 shutdown=113 shutter=-3 shutters=-51 shy=-29 side=-153 side's=-29 side_=-159
    side_and=-200 side_are=-70 side_as=-21 side_by=-70 side_chapel=-85 side_door=-161
    side_of=-153 side_right=-3 side_the=-85 side_to=-85 sideboard=-106 sides=34 sides_=43
    sideways=113 sierra=-29 sight=147 sign=-87 sign_=-111 sign_and=-139 sign_for=-3
    sign_with=-85 signal=165 signature=49 signed=113 signs=21 silence=165 sill=-50 sill_=-85
    silly=103 silver=43 simon=165 simple=-3 simpler=49 simplified=49 simply=113 simulation=113
    since=132 since_the=-8 sincere=49 sing=132 singing=-29 single=10 single_step=95 sink=-128
    sink_=-200 sink_and=-17 sink_in=4 sink_is=62 sinks=-151 sinks_=-110 sinks_and=-139 sir=84
    sister=132 sister's=113 sit=123 sit_down=147 sit_on=-21 site=116 sitrep=49 sits=-8
    sitting=-70 sitting_area=-85 sitting_room=-85 situate=-29 situated=-70 situation=49 six=48
    six_=46 six_in=136 six_steps=-99 sixth=-110 sixty=20 size=-99 size_bed=-85 skeleton=-161
    skeleton_=-99 ski=-51 skimming=-29 skinny=-85 skip=97 skip_the=89 skipped=165 skirt=-85
    skirted=-29 skirting=84 skis=-70 skull=-51 skylight=-84 skylight_=-66 skylight_in=-70
    skylights=-29 slalom=-29 slats=-3 slatted=20 sleep=200 sleepin=-29 sleeping=46 sleeps=-29
    sleepy=113 sleeve=49 slept=106 slide=75 slider=-110 slides=-51 sliding=-200
    sliding_door=-200 sliding_doors=-200 sliding_glass=-121 slight=-200 slight_left=-200
    slight_right=-199 slightly=-200 slightly_left=-200 slightly_right=-200 slightly_to=-70
    slinks=-29 slip=43 slippers=-51 slippery=-29 slope=-29 slopes=-29 sloping=-29 slot=-51
    slots=-29 slow=85 slowing=49 slowly=-139 sm=-29 small=-157 small_door=-180 small_gate=-70
    small_hallway=-70 small_office=-70 small_room=-85 small_steps=-70 small_table=-171
    smalls=-29 smart=113 smartest=113 smell=170 smells=74 smelly=-29 smh=81 smidge=-51 smile=-70
    smoke=113 smooth=-29 snack=-99 snail=62 snake=132 snapped=113 sneak=62 sneaks=-29 sneeze=49
    snooker=49 snow=165 snuggled=-29 so=65 so_=53 so_and=-70 so_as=-62 so_be=43 so_do=108
    so_find=-85 so_get=-70 so_go=-126 so_here=53 so_i=73 so_i'll=156 so_i've=53 so_if=-3
    so_is=80 so_it's=40 so_just=-42 so_keep=46 so_kind=62 so_let's=-85 so_no=53 so_not=-70
    so_on=103 so_past=-130 so_please=156 so_rotate=66 so_stop=-48 so_take=125 so_that=-176
    so_that's=-4 so_the=85 so_there=136 so_turn=-34 so_um=-70 so_use=66 so_walk=-58 so_we=147
    so_you=-48 so_you'd=-110 so_you're=-90 soak=-29 soccer=-29 sock=113 socks=62 sofa=0
    sofa's=113 sofa_=4 sofa_and=-85 sofa_is=46 sofa_on=-92 sofa_the=-70 sofas=110 sofas_=-3
    soffit=-29 soft=46 softly=84 software=113 sold=176 soldier=62 solitary=-29 solve=165
    solved=113 some=-15 some_stairs=-21 somebody=178 somebody_has=136 somebody_is=62 somehow=49
    someone=200 someone's=-29 someone_else=199 something=200 something_=154 sometimes=-29
    somewhere=88 son=49 song=84 soon=-76 soon_as=-115 sooner=-29 soonest=49 sooo=53 soooo=49
    sore=49 sorry=84 sorry_=103 sorry_i=75 sort=-109 sort_of=-104 sought=-29 soul=113 sound=-29
    sound_desk=-85 sounding=113 sounds=49 soup=91 soup's=49 source=-29 south=165 spa=-121
    spa_=-86 space=66 space_between=-70 spam=113 span=-29 spare=43 spare_bedroom=-70
    sparkling=-29 spawned=49 speak=176 speaker=125 speaker_=-3 speakers=-29 speaking=200
    speaks=113 special=113 species=-29 specifically=-29 speculation=113 speed=195 spell=113
    spelled=113 spelling=113 spells=113 spending=113 spent=49 spiders=-51 spiky=49 spill=113
    spilled=62 spilt=-29 spin=148 spin_around=80 spin_on=200 spinning=-70 spiral=-200
    spiral_staircase=-200 spiral_stairs=-99 spirit's=49 splash=-29 split=81 splits=-185
    splits_in=-70 spoken=113 spoon=200 sport=49 sports=-29 spot=52 spot_=12 spot_a=-70
    spotted=113 spread=113 spring=186 sprint=-29 squad=-51 square=-24 square_table=-78
    squared=84 squares=-51 squeaks=-29 squeeze=-110 squeeze_between=-70 squeezed=-29 squirts=-29
    squishy=-29 sry=20 st=-21 stable=-51 stables=-51 stack=-48 stack_of=-161 stacked=-110
    stadium=49 staff=-30 staff_only=-130 stage=-135 stage_=-42 stage_and=-85 stage_behind=-70
    stage_up=-70 stain=62 stained=-190 stained_glass=-190 stair=-30 stair_=-70 stair_without=-70
    staircase=-96 staircase_=-119 staircase_and=-188 staircase_b=-3 staircase_but=-85
    staircase_is=-70 staircase_of=-85 staircase_on=-165 staircase_to=-110 staircase_which=43
    staircases=-36 stairs=-85 stairs_=-66 stairs_all=-85 stairs_and=-93 stairs_are=-17
    stairs_beside=-121 stairs_but=-85 stairs_down=-34 stairs_go=-99 stairs_going=-50
    stairs_into=-70 stairs_next=-139 stairs_not=-62 stairs_on=-131 stairs_one=-70
    stairs_past=-85 stairs_take=-110 stairs_that=-8 stairs_the=-70 stairs_then=-106
    stairs_to=-200 stairs_turn=-195 stairs_up=-121 stairs_walk=-92 stairs_were=176
    stairs_which=-99 stairs_with=-168 stairs_you=-3 stairway=-200 stairway_=-200
    stairway_and=-188 stairway_on=-110 stairways=113 stairwell=-161 stall=-82 stalls=-62
    stalls_=-3 stand=-77 stand_=-20 stand_a=-70 stand_and=-122 stand_at=15 stand_by=-4
    stand_in=3 stand_next=-200 stand_of=-70 stand_on=-77 stand_still=139 stand_then=-92
    stand_turn=-70 stand_with=-200 standard=-29 standing=-20 standing_in=-143 standing_on=-50
    stands=18 standstill=-29 star=-130 star_=-70 starboard=-85 staring=-29 stars=15 stars_on=-70
    start=54 start_=200 start_at=-98 start_by=-200 start_from=-21 start_in=-155 start_there=-70
    start_with=28 started=186 starting=-37 starting_at=-200 starts=165 starve=113 state=103
    statement=113 static=113 station=-78 station_=-99 station_and=-34 stationary=-29
    stationed=-29 statue=-189 statue_=-85 statue_and=-143 statue_of=-168 statues=62 status=165
    stay=170 stay_=200 stay_here=200 stay_in=93 stay_on=-147 stay_put=195 stay_there=85
    stay_where=200 stayed=49 staying=-70 stays=43 stead=-29 steady=-51 steam=-131
    steam_room=-155 steel=-185 steel_door=-85 steep=28 steeper=-29 steeplechase=-29 steeply=-29
    steer=49 steered=-29 steering=84 step=-50 step_=-5 step_and=24 step_away=-130 step_down=-36
    step_inside=-70 step_into=-200 step_is=15 step_of=80 step_on=62 step_one=-70 step_out=-157
    step_over=-200 step_stop=-78 step_turn=-121 stepping=-121 stepping_stones=-85 steps=-79
    steps_=-70 steps_and=-200 steps_at=-99 steps_back=136 steps_between=-70 steps_down=-200
    steps_forward=-130 steps_go=-85 steps_going=-85 steps_into=-147 steps_of=-99 steps_on=-200
    steps_that=-110 steps_then=-188 steps_to=-200 steps_turn=-70 steps_up=-85 steward=-29
    stewards=49 stick=-29 sticks=-85 stifling=-29 still=177 still_=195 stinky=-29 stirrers=-51
    stn=-29 stone=-200 stone_bench=-99 stone_floor=-85 stone_lions=-70 stone_stairs=-110
    stone_steps=-180 stones=-36 stood=55 stool=-200 stool_=-200 stool_and=-139 stool_then=-110
    stool_with=-70 stools=-200 stools_=-185 stools_and=-147 stools_to=-85 stools_turn=-78
    stoolss=-41 stop=-190 stop_=-123 stop_1=-139 stop_a=-200 stop_action=199 stop_and=-10
    stop_as=95 stop_at=-200 stop_be=-70 stop_before=-100 stop_behind=-200 stop_beside=-200
    stop_between=-200 stop_by=-200 stop_don't=62 stop_facing=-200 stop_following=199
    stop_halfway=-70 stop_here=50 stop_i=-70 stop_in=-200 stop_inside=-161 stop_is=88
    stop_just=-200 stop_near=-82 stop_next=-200 stop_now=200 stop_nxt=-70 stop_on=-200
    stop_once=-200 stop_outside=-200 stop_right=-200 stop_short=-70 stop_stop=113 stop_the=-70
    stop_there=-200 stop_to=-113 stop_um=-70 stop_under=-200 stop_when=-200 stop_where=39
    stop_with=-200 stop_you=62 stopped=-27 stopped_at=-62 stopping=13 stopping_=136 stops=-160
    stops_=-130 stops_at=-36 store=-42 store_=-99 storeroom=-70 storey=-29 storeys=-29 storm=113
    story=136 stove=-181 stove_=-168 stove_and=-193 stove_in=-70 stove_past=-70 stp=-29
    straight=-200 straight_=-158 straight_across=-200 straight_ahead=-200 straight_and=-190
    straight_away=-70 straight_between=-200 straight_down=-200 straight_into=-147
    straight_line=-70 straight_on=-67 straight_out=-200 straight_over=-110 straight_past=-200
    straight_straight=-70 straight_then=-105 straight_through=-197 straight_to=-200
    straight_towards=-70 straight_under=-99 straight_until=-200 straight_with=-70 strait=-51
    stranger=132 strategy=-29 streamers=-51 street=-8 streets=113 stress=-29 stretcher=-51
    stretching=-29 strike=113 strikes=113 string=136 stringed=-29 strings=-51 strip=-29
    striped=-200 striped_blanket=-70 striped_rug=-130 strips=-29 stripy=-85 stroll=-50
    stroll_through=-3 strollers=-29 strs=-29 stubborn=113 stuck=167 stuck_in=103 student=-3
    studio=-24 studio_=-85 study=-188 study_=-131 study_and=-180 study_through=-78 stuff=186
    stuffed=-110 stuffed_bear=-85 stuffy=-29 stunning=-29 style=84 subheading=-70 subj=49
    subject=20 submarine=49 submit=49 subscribe=113 subsequently=-85 success=200 success_=199
    successful=113 successive=-29 such=126 suffice=-29 sugar=43 suggest=-29 suggested=-29
    suit=-155 suit_of=-155 suitable=-29 suitably=-29 suitcase=-29 suitcases=-29 suits=62 sum=106
    sum_up=106 summarise=113 summary=81 summer=-51 summit=-29 sump=-29 sun=-71 sun_loungers=-70
    sun_room=-200 sunburn=49 sunday=132 sundays=49 sundial=-70 sunflowers=-51 sunken=-62
    sunken_living=-3 sunken_lounge=-85 sunny=-29 sunroom=-72 sunroom_=-121 sunroom_and=-70
    sunset=165 sunshine=-29 super=-51 supermarket=49 supersedes=165 superstar=-29
    superstitious=-29 supervisor=200 supplies=49 supply=-29 support=84 supported=-29 suppose=38
    suppose_=-85 suppose_i=-3 suppose_you=-21 sure=-23 surface=-51 surprising=113 surrounded=-29
    surroundings=-29 surrounds=-29 survey=113 sushi=-29 suspended=62 swallow=113 swan=-62
    swan_=-85 swap=200 swap_left=200 swapped=-110 sway=-29 swear=81 sweep=-51 sweet=-99
    sweet_little=-70 sweetheart=84 sweetie=-29 swimmin=-29 swimming=21 swimming_pool=21
    swimsuit=49 swing=-152 swing's=-29 swing_=-174 swing_and=-161 swing_door=-62 swing_doors=-70
    swing_go=-85 swinging=-174 swinging_door=-85 swinging_doors=-130 swings=-90 swingy=-29
    switch=88 switched=165 switches=-110 swivel=-110 swords=-51 swore=81 sworn=-29 system=200
    t=-121 t_=-70 t_junction=-70 ta=-29 tabel=-110 table=-116 table's=-29 table_=-124
    table_and=-200 table_around=-99 table_at=-70 table_between=-99 table_by=62
    table_clockwise=-70 table_for=43 table_go=-85 table_i=62 table_in=-158 table_is=103
    table_keeping=-121 table_on=-151 table_once=27 table_so=-116 table_that=28 table_then=-200
    table_to=-55 table_turn=-126 table_walk=-130 table_where=-99 table_which=-70 table_with=-200
    tables=-1 tables_=-110 tables_with=-70 tablets=-29 tac=113 tack=-51 tackle=-29 tactics=-29
    tada=-29 tail=43 tailor's=-51 tails=113 taiwan=113 take=-66 take_a=-128 take_about=-70
    take_it=-80 take_one=-17 take_the=-125 take_those=62 take_two=54 take_you=-121
    take_your=-121 taken=79 taken_=80 taken_in=62 taken_over=136 taken_up=-85 takes=-3
    takes_a=-85 taking=33 talent=49 talk=147 talking=132 tall=-114 tall_chair=-70 tall_clock=-85
    tall_mirror=-85 taller=-29 tallest=62 tan=-200 tan_chair=-92 tank=-200 tank_=-173
    tank_and=-171 tank_then=-78 tape=-3 tape_=62 tape_on=-70 taped=-29 tapestry=-200
    tapestry_=-171 tapestry_and=-126 tapestrys=-41 target=123 tartan=-29 task=186 task_=196
    tasking=-29 tastes=-29 tasting=-110 tasting_table=-85 taxi=81 tbh=49 tbl=-29 tea=-80
    teacher=113 teacher's=-130 teacher's_desk=-130 teal=-51 team=157 technician=200
    technician_with=167 teddies=-51 teddy=49 teenager=113 teenager's=-29 teeny=-99 teh=28
    telephone=-90 telephone_on=-70 telephones=-29 telescope=-161 telescope_=-121
    telescope_and=-70 television=-76 television_=-168 television_and=-135 television_on=-70
    television_then=-92 televisions=72 tell=200 tell_me=132 tell_the=103 tell_you=200 teller=-82
    teller_window=-85 teller_windows=-3 telling=132 tells=200 tells_you=200 telly=-51
    temperature=-29 tempting=-29 ten=171 tenner=49 tennis=20 tent=-98 tent_=-110 term=-29
    terminal=84 terminate=113 terminates=-51 terminating=-29 termites=113 terms=165 terrace=-155
    terrace_=-90 terrace_and=-85 terraces=-29 terrible=49 terry=49 test=199 testing=49 text=200
    text_=200 text_says=200 text_you=94 texting=49 th=49 than=186 than_a=199 than_the=191
    thank=139 thank_you=173 thanks=179 that=73 that'd=-29 that'll=-29 that's=-21 that's_a=29
    that's_all=-85 that's_at=-70 that's_closest=-70 that's_got=-99 that's_it=-90 that's_not=80
    that's_on=-70 that's_shaped=-70 that's_the=-0 that's_what=62 that's_where=-81 that's_you=-70
    that's_your=-121 that_=118 that_a=-85 that_all=62 that_and=-62 that_are=68 that_but=-3
    that_comes=-70 that_corner=-70 that_door=15 that_follow=106 that_follows=199 that_go=28
    that_goes=86 that_hallway=-3 that_hangs=-130 that_has=-30 that_i=62 that_is=39 that_it=-70
    that_looks=21 that_means=-21 that_must=62 that_nobody=136 that_none=142 that_one=-87
    that_order=103 that_robots=200 that_room=113 that_says=-161 that_table=15 that_the=75
    that_there=118 that_was=200 that_way=55 that_would=30 that_you=137 that_you'll=-85
    that_you're=95 that_your=62 thats=-58 the=-45 the_2=-121 the_3=-121 the_above=199
    the_administrator=200 the_aisle=-200 the_alarm=-130 the_alcove=-85 the_altar=-195
    the_anchor=-110 the_aquarium=-161 the_arcade=-85 the_arch=-200 the_arched=-85 the_arches=-70
    the_archive=-36 the_archway=-200 the_area=-70 the_armchair=-67 the_arrows=-3 the_art=-21
    the_atm=-70 the_atrium=-99 the_attic=-92 the_automatic=-110 the_baby=17 the_back=-148
    the_bakery=-4 the_balcony=-118 the_ballroom=-98 the_bamboo=-70 the_bananas=-70
    the_banister=44 the_bank=-36 the_baptistery=-85 the_bar=-200 the_barbecue=-130 the_barn=-121
    the_barometer=-85 the_barrel=-99 the_barrels=-110 the_base=-110 the_basement=82
    the_basketball=-70 the_bath=-110 the_bathroom=-53 the_bathtub=-116 the_bay=-180 the_bead=-99
    the_beaded=-121 the_beanbag=-130 the_beanbags=-21 the_bed=-77 the_bedroom=-24 the_beds=-121
    the_beginning=200 the_bell=-42 the_bench=-200 the_best=147 the_bicycle=-155 the_bidet=-70
    the_big=-200 the_biggest=-121 the_bike=-139 the_bikes=-85 the_billiard=-85 the_bird=-4
    the_birdbath=-85 the_black=-200 the_blackboard=-168 the_blue=-200 the_board=44
    the_boardroom=-36 the_boiler=-147 the_bookcase=-200 the_bookshelf=-50 the_boot=-121
    the_boots=-110 the_boss=88 the_both=-3 the_bottom=-200 the_bowl=-3 the_branch=-85
    the_brass=-168 the_bread=-110 the_break=-110 the_breakfast=-189 the_brick=-180
    the_bridge=-23 the_brochure=-85 the_bronze=-70 the_brown=-200 the_bucket=-99 the_buffet=-121
    the_building=111 the_bulletin=-130 the_bunk=-200 the_bust=-147 the_cabin=-200
    the_cabinet=-200 the_cactus=-161 the_cafe=-99 the_cake=-85 the_candle=-177 the_candles=-121
    the_candy=43 the_canopy=-85 the_captain's=-85 the_car=21 the_card=-110 the_carpet=-90
    the_carpeted=-168 the_case=-3 the_cash=-195 the_casino=-3 the_cat=125 the_cat's=53
    the_cedar=-70 the_ceiling=25 the_cellar=-3 the_cello=-70 the_center=-155 the_central=28
    the_cereal=-121 the_chair=-9 the_chairs=-30 the_chandelier=-200 the_changing=-139
    the_chapel=-49 the_charging=-17 the_chart=-85 the_checkout=-85 the_chess=-99 the_chest=-99
    the_chief=200 the_children's=-85 the_chimney=-72 the_china=-161 the_choir=-99
    the_christmas=-121 the_church=-90 the_circular=-70 the_classroom=-174 the_claw=-70
    the_cloakroom=-90 the_clock=-105 the_closed=-147 the_closest=-147 the_closet=-125
    the_coat=-200 the_coats=-90 the_coffee=-187 the_cold=-121 the_column=-151 the_columns=-70
    the_computer=-135 the_concierge=-85 the_concrete=-70 the_conference=-200
    the_confessional=-110 the_conservatory=-50 the_contrary=200 the_control=62 the_copier=-195
    the_corner=-200 the_corridor=-116 the_costumes=-70 the_couch=72 the_counter=-46
    the_courtyard=-174 the_covered=-85 the_crib=-200 the_crowd=80 the_crypt=-99 the_crystal=-85
    the_cubbies=-3 the_cubicles=-85 the_cue=-70 the_cupboard=80 the_current=200 the_curtain=-200
    the_curtained=-85 the_curtains=80 the_curved=-147 the_customer=62 the_dance=-99 the_dark=-50
    the_darkroom=-85 the_dartboard=-139 the_deck=-200 the_deep=-110 the_deer=-85 the_den=-200
    the_description=200 the_desk=-200 the_desks=-130 the_dining=-69 the_dinosaur=-50
    the_direction=10 the_directions=200 the_dishwasher=-200 the_display=-200 the_distance=-130
    the_diving=-99 the_doctor's=21 the_dog=84 the_door=-144 the_doormat=-161 the_doors=-32
    the_doorway=-200 the_double=-200 the_drawing=-70 the_dresser=-200 the_dressing=-185
    the_drinking=-121 the_drinks=-85 the_drive=176 the_drum=-174 the_drums=-99 the_dryer=-155
    the_easel=-130 the_east=96 the_edge=-200 the_elevator=-192 the_elevators=-168 the_end=-143
    the_engine=-99 the_entrance=-189 the_entryway=-200 the_episode=199 the_er=-161
    the_escalator=-200 the_exercise=-52 the_exit=-63 the_eye=3 the_family=-93 the_far=-200
    the_farther=-99 the_fence=-110 the_fern=-99 the_ficus=-3 the_fifth=-85 the_filing=-130
    the_final=125 the_finish=80 the_fire=-78 the_fireplace=-139 the_first=-55 the_fish=-200
    the_fitting=-130 the_five=-130 the_floor=15 the_flower=-155 the_flowers=-99 the_folding=-147
    the_following=200 the_font=-155 the_foosball=-70 the_foot=-200 the_footbridge=-99
    the_footstool=-70 the_forklift=-21 the_fountain=-200 the_four=-198 the_fourth=-35
    the_foyer=-171 the_framed=-70 the_freezer=-174 the_french=-200 the_fridge=41 the_front=-129
    the_frosted=-110 the_fruit=-21 the_full=28 the_fume=-70 the_furniture=200 the_fuse=-3
    the_gallery=-174 the_game=-96 the_gap=-130 the_garage=-86 the_garden=-4 the_gas=28
    the_gate=-179 the_generator=-70 the_giant=-70 the_gift=-155 the_glass=-200 the_globe=-200
    the_goal=200 the_gold=-139 the_grand=-85 the_grandfather=-200 the_grass=-82 the_gravel=-70
    the_gray=-200 the_great=-50 the_green=-200 the_greenhouse=-29 the_grey=-200 the_grill=-200
    the_ground=46 the_guest=-200 the_guitar=-85 the_gumball=-110 the_gym=-189 the_hair=-70
    the_half=-155 the_hall=-160 the_hallway=-102 the_hammock=-85 the_hand=43 the_handrail=-85
    the_hanging=-139 the_harp=-161 the_harpsichord=-99 the_hat=-34 the_hatch=-121 the_hay=-70
    the_head=88 the_hearth=-70 the_heated=-99 the_heavy=-121 the_hedge=-121 the_high=-161
    the_hmm=-85 the_hole=-70 the_hooks=-21 the_horse=-99 the_hospital=-8 the_hot=-200
    the_hotel=-80 the_house=86 the_huge=-99 the_i=-70 the_ice=-195 the_indoor=-85
    the_information=-110 the_inner=-99 the_inside=-85 the_instruction=200 the_instructions=66
    the_intended=-70 the_iron=-185 the_ironing=-174 the_island=-168 the_jacuzzi=-180
    the_judge's=-70 the_jukebox=-93 the_jury=-85 the_keeper's=-70 the_key=147 the_keyboard=-21
    the_kiln=-85 the_king=62 the_kitchen=-33 the_kitchenette=-36 the_l=-70 the_lab=-70
    the_ladder=-144 the_lady=-99 the_lake=-3 the_lamp=-79 the_landing=-170 the_landlord=199
    the_lantern=-85 the_large=-200 the_largest=-99 the_last=18 the_laundry=-63 the_lawn=-110
    the_leather=-200 the_left=-164 the_leftmost=-70 the_length=11 the_letter=113
    the_library=-200 the_life=-121 the_lifeboat=-130 the_lifeboats=-85 the_lifebuoy=-70
    the_lifeguard=-70 the_lift=-14 the_light=-130 the_lily=-85 the_line=-147 the_linen=-200
    the_list=200 the_lit=-85 the_little=-200 the_living=28 the_loading=-82 the_lobby=-200
    the_locker=-72 the_lockers=-200 the_loft=-73 the_long=-182 the_lounge=-32 the_loungers=-85
    the_low=-130 the_lower=-161 the_lowest=-70 the_luggage=-70 the_lunch=-70 the_machine=-23
    the_mail=-3 the_mailbox=-155 the_mailboxes=-147 the_main=-139 the_makeup=-70 the_man=46
    the_mannequin=-110 the_mannequins=-121 the_map=160 the_marble=-200 the_massage=-119
    the_master=-144 the_mat=-172 the_mayor=30 the_meeting=-8 the_metal=-200 the_meteorite=-70
    the_mezzanine=-110 the_microfilm=-85 the_microphone=80 the_microwave=-200 the_middle=-96
    the_milk=-70 the_mirror=-186 the_mirrored=-85 the_mirrors=-110 the_mop=-110 the_most=62
    the_moving=-110 the_mud=-200 the_mudroom=-147 the_mummy=-85 the_museum=49 the_music=-155
    the_narrow=-190 the_nave=-99 the_near=28 the_nearest=-38 the_net=53 the_new=200
    the_newel=-70 the_newspaper=-110 the_newspapers=-85 the_next=-3 the_nightstand=-200
    the_north=62 the_notice=-85 the_number=88 the_nurse's=-139 the_nursery=-200 the_nurses=-161
    the_object=200 the_ocean=-70 the_office=-200 the_oh=-85 the_old=91 the_one=-20 the_ones=-8
    the_only=-3 the_open=-200 the_opening=-190 the_opposite=123 the_orange=-198 the_order=200
    the_organ=-174 the_other=22 the_others=170 the_ottoman=-200 the_outdoor=-85 the_outside=-147
    the_oval=-155 the_oven=-63 the_owner=200 the_paint=-85 the_painting=-55 the_pallets=-85
    the_pantry=-66 the_paper=-85 the_parking=-85 the_parlor=-3 the_parquet=-70 the_part=200
    the_passage=-190 the_path=-1 the_patio=-200 the_pavilion=-70 the_pay=-85 the_penguin=-3
    the_people=-34 the_person=200 the_pews=-180 the_phone=-90 the_photo=-130 the_photos=-99
    the_piano=-74 the_picture=-12 the_pictures=-70 the_pillar=-200 the_pillars=-85
    the_pinball=-85 the_ping=-121 the_pink=-165 the_place=165 the_plan=200 the_plant=-62
    the_plants=62 the_plaque=-130 the_playroom=-139 the_plunge=-147 the_podium=-85 the_point=-70
    the_police=186 the_pond=-85 the_pool=-200 the_popcorn=-147 the_porch=-200 the_portrait=-168
    the_post=62 the_poster=34 the_potted=-200 the_pottery=-99 the_pretty=-70 the_previous=200
    the_printer=-180 the_projector=-21 the_promenade=-85 the_pulpit=-151 the_pump=-85
    the_puppet=-85 the_purple=-200 the_rack=-155 the_racks=-85 the_radiator=-106
    the_radiators=-85 the_rail=-147 the_railing=-200 the_railings=-70 the_rain=-50 the_ramp=-200
    the_reading=-72 the_real=78 the_rear=-121 the_reception=-200 the_record=-110 the_red=-200
    the_refrigerator=-200 the_remainder=195 the_remaining=100 the_rest=200 the_restaurant=-110
    the_restrooms=-85 the_returns=-3 the_reverse=200 the_revolving=-190 the_right=-172
    the_robot=27 the_rocking=-195 the_rolled=-70 the_roller=-70 the_roof=104 the_room=-106
    the_rooms=199 the_rope=-185 the_round=-200 the_route=200 the_row=-200 the_rowing=-121
    the_rows=-99 the_rubber=-70 the_rug=-141 the_rules=170 the_run=170 the_safety=196
    the_salad=-99 the_salon=-70 the_same=108 the_sandbox=-70 the_sauna=-200 the_scale=-190
    the_scales=-70 the_school=-70 the_science=-3 the_scoreboard=-70 the_screen=-185
    the_scullery=-110 the_sculpture=-171 the_sea=156 the_seats=-70 the_second=-171
    the_security=-161 the_sentence=200 the_servants=-70 the_server=80 the_service=28
    the_set=-174 the_sewing=-161 the_shed=-85 the_shelf=-200 the_shelves=-155 the_shelving=-70
    the_shiny=-110 the_ship=-3 the_shoe=-200 the_shoes=-99 the_shop=15 the_shopping=-85
    the_short=-24 the_shower=-107 the_showers=-147 the_shredder=-70 the_side=-200
    the_sideboard=-98 the_sign=-30 the_sill=-50 the_silver=-70 the_sink=-181 the_sinks=-147
    the_site=116 the_sitting=-110 the_six=-99 the_sixth=-110 the_skeleton=-85 the_skylight=-113
    the_sleeping=-85 the_sliding=-200 the_small=-200 the_snack=-85 the_sofa=33 the_sound=-110
    the_spa=-149 the_space=-70 the_spare=-70 the_speaker=62 the_spiral=-200 the_spot=125
    the_square=-13 the_stack=-139 the_stacked=-99 the_staff=62 the_stage=-200 the_stained=-147
    the_stair=-70 the_staircase=-74 the_stairs=-92 the_stairway=-200 the_stairwell=-147
    the_stand=-70 the_star=-99 the_start=200 the_station=-85 the_statue=-132 the_steam=-168
    the_steel=-110 the_steep=-85 the_step=62 the_stepping=-85 the_steps=-97 the_stone=-200
    the_stool=-200 the_stools=-85 the_stop=100 the_store=-70 the_stove=-200 the_street=-8
    the_striped=-200 the_studio=-72 the_study=-200 the_stuffed=-70 the_suit=-130 the_sun=-113
    the_sundial=-70 the_sunken=-99 the_sunroom=-61 the_supervisor=200 the_swimming=-110
    the_swing=-200 the_swinging=-147 the_swings=-99 the_t=-121 the_table=-4 the_tables=-110
    the_tall=-200 the_tan=-200 the_tape=-99 the_tapestry=-177 the_target=136 the_task=199
    the_tasting=-110 the_tea=-147 the_teacher's=-130 the_telephone=-121 the_telescope=-147
    the_television=-98 the_tent=-130 the_terrace=-174 the_text=200 the_the=-200 the_theater=-200
    the_thermostat=-70 the_thing=86 the_third=-180 the_three=-200 the_threshold=-200
    the_throne=-161 the_ticket=-200 the_tile=-121 the_tiled=-70 the_tiles=3 the_till=-99
    the_time=126 the_tiny=-99 the_toaster=30 the_toilet=25 the_toilets=-70 the_tomatoes=-85
    the_top=-200 the_tour=136 the_towel=-200 the_towels=15 the_tower=-62 the_toy=-147
    the_tracks=-85 the_train=11 the_trash=-200 the_treadmill=-200 the_treadmills=-110
    the_tree=-21 the_trip=200 the_trophies=-70 the_trophy=-155 the_trunk=-110 the_tub=-200
    the_turns=199 the_turnstile=-155 the_turnstiles=-85 the_tv=-200 the_two=-137
    the_typewriter=-70 the_um=-200 the_umbrella=-200 the_unit=200 the_update=199 the_upper=80
    the_uppermost=-85 the_upstairs=-3 the_urn=-85 the_user=200 the_user's=200 the_utility=-200
    the_vacuum=-85 the_vanity=-190 the_vase=-87 the_vault=-3 the_velvet=-139 the_vending=-175
    the_very=-55 the_vestibule=-85 the_vestry=-99 the_volcano=-70 the_waiting=-193 the_walk=106
    the_wall=-61 the_walls=80 the_ward=43 the_wardrobe=-200 the_washer=-200 the_washing=-183
    the_water=-200 the_way=-33 the_wedding=30 the_weight=-110 the_well=-121 the_wet=-70
    the_whale=-121 the_wheel=-21 the_wheelbarrow=-85 the_wheelchair=-85 the_wheelchairs=-85
    the_while=126 the_white=-200 the_whiteboard=-200 the_whole=136 the_wicker=-195 the_wide=-85
    the_wigs=-85 the_window=-98 the_windows=-91 the_windowsill=-70 the_wine=-167 the_wobbly=-99
    the_woman=43 the_wood=-110 the_wooden=-200 the_word=200 the_words=200 the_workbench=-161
    the_workshop=-21 the_wrong=200 the_yard=3 the_yellow=-200 the_yoga=-70 theater=-200
    theater_room=-200 theater_with=-70 theatre=-21 their=144 theirs=49 them=-21 them_=-17
    them_all=62 them_and=-175 them_in=200 them_on=-62 them_to=-130 themselves=-70 then=-200
    then_=106 then_a=-190 then_after=-139 then_another=-99 then_as=-126 then_at=-200
    then_bear=-116 then_climb=-151 then_come=-161 then_continue=-177 then_cross=-200
    then_descend=-171 then_down=-110 then_enter=-195 then_er=-121 then_follow=-200
    then_forward=-70 then_go=-200 then_hang=-147 then_head=-200 then_hmm=-70 then_i=-72
    then_i'd=-3 then_immediately=-99 then_in=-21 then_it=-85 then_it's=-200 then_just=-70
    then_keep=-200 then_left=-200 then_look=-70 then_make=-126 then_move=-171 then_once=-171
    then_out=-147 then_pass=-200 then_past=-200 then_proceed=-200 then_right=-185 then_rite=-70
    then_slightly=-70 then_stand=-110 then_step=-188 then_stop=-200 then_straight=-99
    then_take=-200 then_that=-139 then_the=-118 then_there's=-185 then_through=-121 then_to=-139
    then_turn=-200 then_up=-99 then_veer=-85 then_wait=-200 then_walk=-200 then_well=-70
    then_when=-168 then_you=-200 then_you'd=-110 then_you'll=-110 then_you're=-82 thence=-29
    theory=113 therapist=113 there=-58 there'll=-72 there'll_be=-72 there's=-64 there's_a=-123
    there's_an=-50 there's_no=144 there's_only=-17 there's_the=-141 there_=-76 there_and=-111
    there_are=-68 there_at=-70 there_but=-99 there_for=-17 there_go=-121 there_if=-70
    there_is=-27 there_isn't=118 there_it=-139 there_it's=-70 there_kindly=-70 there_make=-70
    there_might=-70 there_one=-110 there_should=-168 there_so=-110 there_take=-85 there_the=62
    there_to=43 there_turn=-99 there_was=132 there_were=118 there_will=-200 there_with=-36
    there_without=-70 there_you=-85 thereafter=-155 thereby=-29 therefore=80 thereof=-70
    theres=-34 theres_a=-17 thereupon=-29 thermal=113 thermostat=-70 thermostat_=-70 these=165
    these_commands=199 these_directions=200 they=140 they'll=49 they're=-65 they're_both=-70
    they've=-21 they_are=193 they_go=-85 they_have=-3 they_say=195 they_tell=176 they_turn=-99
    they_were=200 theyre=-70 thick=-29 thin=-50 thing=57 thing's=49 thing_=88 thing_is=-42
    thing_number=-70 thing_to=-90 thing_with=95 thing_you=78 things=183 things_=147 think=39
    think_=82 think_and=-99 think_it=-130 think_it's=-17 think_of=193 think_that's=-85
    think_the=53 think_um=-85 think_you=68 thinking=175 thinking_about=161 thinks=113 third=-136
    third_=-42 third_column=-85 third_desk=-70 third_door=-100 third_right=-92 third_row=-130
    third_step=-85 third_window=-110 thirdly=-29 thirteen=113 thirtieth=113 thirty=12 this=200
    this_=200 this_at=134 this_building=200 this_corridor=-85 this_down=53 this_floor=195
    this_home=136 this_house=200 this_is=200 this_line=170 this_message=200 this_moment=136
    this_morning=147 this_one=68 this_place=118 this_room=34 this_route=200 this_run=183
    this_says=156 this_sentence=200 this_step=80 this_task=200 this_text=200 tho=-29 thorough=49
    thoroughly=49 those=2 those_=-110 those_and=-85 those_are=-70 those_two=-85 thou=113
    though=56 thought=77 thoughts=113 thread=113 threaded=-29 three=-52 three_=-110
    three_and=-70 three_doors=-174 three_floors=-3 three_four=62 three_in=103 three_is=-70
    three_little=-70 three_o'clock=-70 three_stairs=-126 three_stairway=-110 three_steps=-200
    three_times=200 threshold=-200 threshold_and=-200 throne=-67 throne_=-99 throne_and=15
    through=-192 through_=-200 through_90=-70 through_a=17 through_and=-26 through_both=-70
    through_door=-70 through_it=-134 through_its=-70 through_that=-4 through_the=-200
    through_them=-70 through_there=-85 through_those=-70 through_two=62 throughout=84 throw=200
    throwing=49 thrown=113 throws=-29 thru=-195 thru_=-70 thru_the=-155 thumbs=-29 thumping=-29
    thunderstorm=113 thursday=113 thx=-3 thyself=113 tic=113 tick=-29 ticked=113 ticket=-66
    ticket_booth=-110 ticket_desk=-85 ticket_machine=-110 tickle=-29 ticks=-29 tiddles=49
    tide=113 tidy=113 tidying=49 tie=132 tied=-51 tiger=-3 tight=-85 til=-110 tile=-195
    tiled=-130 tiles=19 tiles_=-110 till=-110 till_it=-70 till_the=-190 till_there's=-70
    till_you=-200 time=178 time_=177 time_and=-85 time_i=97 time_you=200 timeout=113 timer=-29
    times=187 times_=200 times_before=136 tin=199 tinned=-29 tins=-29 tinsel=-85 tiny=-168
    tiny_bit=-70 tiny_chairs=-70 tips=113 tiptoe=-70 tiptoes=49 tired=147 titchy=-29 title=165
    tl=113 to=-21 to_=200 to_a=-113 to_advance=-70 to_an=-168 to_and=-121 to_another=62
    to_approach=136 to_arrive=-85 to_ascend=-121 to_be=133 to_begin=-62 to_blue=-3 to_carry=142
    to_come=113 to_descend=136 to_disregard=125 to_do=78 to_drop=81 to_end=180 to_enter=-17
    to_exit=-70 to_face=-30 to_find=60 to_follow=129 to_gate=-85 to_get=-30 to_go=74 to_have=96
    to_his=-70 to_it=-138 to_its=-28 to_keep=-99 to_leave=193 to_look=-61 to_make=125 to_me=200
    to_move=136 to_my=147 to_one=15 to_open=3 to_pass=-155 to_proceed=-155 to_put=-36
    to_reach=43 to_reaching=-70 to_read=154 to_remain=43 to_rest=-121 to_return=118 to_row=-70
    to_say=-5 to_see=111 to_sit=96 to_stand=-121 to_stay=199 to_stop=13 to_take=53 to_tell=200
    to_that=-110 to_the=-125 to_them=15 to_think=136 to_this=200 to_tile=-85 to_turn=-63
    to_undo=66 to_wait=15 to_walk=123 to_where=89 to_which=136 to_whom=103 to_write=106
    to_you=200 to_your=-63 to_zero=136 toast=49 toaster=30 tobacco=-29 tobacconist=-29 tock=-29
    today=200 today's=11 today_=200 toddle=-51 toddler=-29 todo=113 toe=84 toes=-51 together=62
    together_=53 toilet=-1 toilet_=50 toilet_ahead=-92 toilet_and=-200 toilet_is=62 toilets=43
    tokens=113 told=200 told_me=200 told_to=200 told_you=196 tolerance=-29 tomatoes=-85
    tomatoes_and=-85 tomb=-51 tombs=-51 tomorrow=199 tones=49 tonight=96 tonight_=147 tons=113
    too=114 too_=130 too_and=-70 too_far=-66 took=53 tool=43 tool_bench=-70 toolbox=-29 tools=-3
    top=-167 top_=-144 top_and=-15 top_by=-70 top_floor=-70 top_go=-121 top_of=-200
    top_stair=-70 top_take=-85 top_there=-70 top_turn=-121 top_you=-70 top_you'll=-70
    tornado=113 toss=113 touch=-9 touch_the=15 touchdown=-29 touched=-29 touches=-29 touching=43
    tour=125 toward=-147 toward_the=-200 towards=-200 towards_it=-85 towards_the=-200 towel=-200
    towel_=-99 towel_rack=-200 towels=-48 towels_=-113 tower=-98 tower_=-70 town=113 toxic=113
    toy=-185 toy_chest=-130 toys=-85 trace=113 track=-70 track's=49 tracking=113 tracks=-85
    tractor=33 tractor_=43 tractors=-29 trade=113 traded=113 traffic=200 trailer=-70 train=22
    train_goes=62 train_set=-99 trained=113 training=113 trains=-51 trajectory=-29
    trampoline=-51 transfer=-29 transferred=49 transition=-29 translate=136 translated=113
    translating=113 translation=-51 translator=113 transport=113 trap=200 trap_=200 trapdoor=-51
    trapped=165 trash=-200 trash_can=-200 travel=154 travels=-29 traverse=-99 traverse_the=-85
    traversed=-29 tray=62 tread=-29 treadmill=-200 treadmill_=-200 treadmill_and=-130
    treadmill_turn=-92 treadmills=-139 treadmills_=-70 treads=-85 treasure=53 treasure's=49
    treat=200 treat_all=200 treat_the=200 treatment=-99 tree=-79 tree_=-67 tree_and=-85
    tree_in=-3 treehouse=-51 trees=-85 trespassing=113 trestle=-51 tried=81 trigger=113 trip=200
    tripod=-3 tripod_=-3 trips=49 trolley=-50 trolley_=-70 trolleys=-51 trophies=-99
    trophies_=-70 trophy=-119 trophy_cabinet=-85 trophy_case=-90 trot=-29 trotting=-29
    trouble=20 trough=-99 trucks=-29 true=136 truly=113 trumpet=113 trun=-110 trunk=3 trunk_=62
    trust=200 trust_me=176 trusted=165 truth=113 try=62 trying=81 ts=113 tsunami=113 tub=-200
    tub_=-200 tub_and=-147 tub_to=-78 tucked=-29 tuesday=186 tuesdays=49 tulips=-21 tumble=-51
    tummy=-29 tummy's=49 tune=-51 tuner=-29 tunnel=20 tunr=113 turn=-130 turn_=103 turn_180=-110
    turn_90=-200 turn_about=-70 turn_and=55 turn_around=-128 turn_at=-130 turn_away=88
    turn_back=189 turn_go=62 turn_in=28 turn_into=-110 turn_is=114 turn_left=-200 turn_of=-85
    turn_off=113 turn_on=136 turn_right=-200 turn_round=-0 turn_sharp=-185 turn_sharply=-70
    turn_slightly=-200 turn_so=-99 turn_the=200 turn_to=-200 turn_toward=-70 turn_until=-99
    turn_your=-200 turned=57 turned_into=62 turned_left=53 turned_right=80 turning=72
    turning_left=-85 turning_on=94 turns=187 turns_=175 turns_right=-70 turnstile=-174
    turnstile_=-110 turnstile_and=-85 turnstiles=-85 tutor=49 tv=-200 tv_=-200 tv_and=-161
    tv_on=-70 tvs=-29 twang=-29 twelve=15 twelve_=-70 twenty=53 twice=148 twice_=125
    twice_without=116 twin=-3 twins=49 twirl=178 twirl_in=134 twist=-29 twit=-29 two=-60
    two's=-29 two_=69 two_and=-121 two_armchairs=-99 two_beds=-70 two_bookshelves=-70
    two_chairs=62 two_closed=-85 two_computer=-85 two_couches=-85 two_doors=-73 two_doorways=-70
    two_flights=-125 two_floors=-121 two_hallways=-99 two_leather=-85 two_lefts=-3 two_long=-85
    two_of=-3 two_paintings=-85 two_pillars=-85 two_rooms=-121 two_rows=-110 two_sets=-99
    two_sinks=-99 two_small=-70 two_sofas=-70 two_staircases=-21 two_steps=-56 two_stone=-70
    two_three=28 two_white=-70 txt=49 ty=-29 type=62 typed=165 typewriter=-85 typewriter_=-70
    typing=103 typo=165 tyre=113 u=13 u_=-99 u_turn=-174 ugh=106 uh=3 uiop=113 ull=-70 um=-144
    um_at=-70 um_i=-72 um_it's=-3 um_right=-70 um_the=-195 um_with=-70 um_you=-139 um_you'd=-85
    umbrella=-192 umbrella_=-36 umbrella_stand=-200 unavailable=113 unchanged=113 uncle=147
    under=-76 under_a=-70 under_it=-147 under_no=136 under_the=-145 undergoing=-29 underneath=-8
    underneath_the=-70 understand=157 understood=199 understood_as=199 understudy=-29
    undertaking=49 undo=200 undo_what=174 unfamiliar=49 unicorn=-85 uniform=-29 unit=200
    unit_is=199 unit_shall=136 units=159 universe=113 unknown=113 unlawful=113 unless=200
    unless_you=199 unlike=49 unlit=-29 unplug=113 unplugged=113 unreachable=113 unsafe=113
    unspecified=-29 unsubscribe=113 until=-52 until_further=199 until_i=103 until_it=-174
    until_the=-19 until_there's=-85 until_you=-166 until_you're=-147 until_you've=43 unusual=-29
    up=-80 up_=12 up_2=-78 up_a=-110 up_against=-70 up_all=-174 up_and=-6 up_at=28 up_both=-62
    up_by=-85 up_five=-85 up_four=-85 up_from=-70 up_in=49 up_it=-121 up_on=-85 up_one=-81
    up_or=28 up_right=-130 up_the=-194 up_them=-168 up_there=116 up_those=-85 up_three=-168
    up_to=-87 up_two=-151 up_until=-110 up_up=-70 up_with=15 up_you=-70 up_your=62 update=200
    updated=113 upfield=-29 upgraded=113 upholstered=-51 upholstery=-29 upon=-163 upon_a=62
    upon_arriving=-70 upon_the=-190 upon_your=-99 upper=66 uppermost=-85 ups=-51 upside=170
    upside_down=170 upstairs=85 upstairs_=100 upstairs_in=-85 upward=-21 upwards=-51 ur=20
    ur_left=-110 ur_right=-99 urer=113 urgent=132 urgently=113 urn=-130 urn_=-99 urs=-29 us=156
    us_=43 us_a=-70 use=74 use_it=62 use_the=14 use_to=-21 used=105 used_=33 used_to=100
    useless=113 user=200 user's=200 uses=165 using=-124 using_the=-200 usual=113 usually=20
    utility=-200 utility_room=-200 utilized=-51 utmost=-29 vacated=-29 vacuum=29
    vacuum_cleaner=33 vague=113 valid=199 validity=113 van=-4 van_and=-70 vanity=-200
    vanity_=-85 vanity_and=-151 vanitys=-41 various=-29 vase=-121 vase_=-200 vase_of=-70
    vase_on=-116 vases=-130 vault=-4 vault_=-3 vaulting=-51 vector=-29 veer=-200 veer_a=-85
    veer_left=-174 veer_right=-151 veer_slightly=-85 veering=-51 vegetables=-29 vehicle=20
    velocity=-29 velodrome=49 velvet=-139 velvet_rope=-99 vending=-182 vending_machine=-200
    vending_machines=-62 veranda=-70 verb=199 verification=-29 verify=-29 version=200
    versions=113 vertical=-51 very=20 very_first=28 very_last=-70 very_sharp=-70 vessel=-29
    vessel's=-29 vestibule=-85 vestry=-99 vests=-29 vetoed=113 via=-161 via_the=-130 vibe=-29
    vicinity=-29 vicious=-29 view=-174 view_=-85 viewing=-51 viewpoint=113 villain=113 vine=-3
    vineyard=-29 violin=113 vip=49 virus=113 vise=-51 visibility=49 visible=62 vision=113
    visit=88 visit_the=136 visitor=-51 visitors=46 visually=-29 voice=176 void=200 void_=200
    void_so=66 voids=113 volcano=-70 voltage=113 volunteer=49 volunteered=49 voted=113
    votive=-51 vowels=113 w=-27 w_the=-50 waffle=-51 waffles=49 waist=-29 wait=-106 wait_=-104
    wait_at=-200 wait_beside=-155 wait_by=-162 wait_for=147 wait_here=51 wait_in=-200
    wait_just=-200 wait_near=-200 wait_next=-200 wait_on=-121 wait_outside=31 wait_there=-200
    wait_under=-130 wait_until=136 waited=-70 waiters=-29 waiting=-16 waiting_=43
    waiting_area=-180 waiting_for=62 waiting_room=-121 waits=-51 wake=84 wakes=113 wakey=49
    wales=49 walk=-166 walk_=200 walk_3=-85 walk_a=-170 walk_across=-200 walk_ahead=-130
    walk_all=-139 walk_along=-200 walk_alongside=-200 walk_and=170 walk_around=-200
    walk_away=-112 walk_back=129 walk_behind=-110 walk_beside=-70 walk_between=-200 walk_by=-200
    walk_down=-200 walk_forward=-200 walk_from=-139 walk_in=-49 walk_inside=-200 walk_into=-132
    walk_is=136 walk_on=-200 walk_out=-200 walk_over=-8 walk_past=-200 walk_round=-85
    walk_straight=-200 walk_the=-20 walk_through=-200 walk_to=-165 walk_toward=-139
    walk_towards=-166 walk_under=-200 walk_until=-200 walk_up=-200 walk_with=-70 walked=-59
    walked_along=-70 walker=113 walking=3 walking_=66 walking_past=-200 walks=125 walkway=-200
    walkway_to=-110 walkway_with=-70 wall=-54 wall_=-133 wall_and=-89 wall_at=103 wall_ends=-70
    wall_is=-70 wall_of=-26 wall_on=-87 wall_past=-110 wall_so=-70 wall_that=113 wall_that's=-85
    wall_to=26 wall_until=-99 wall_with=-155 walled=-29 wallpaper=-99 wallpaper_=-70 walls=51
    walls_=25 walls_and=3 wally=49 walnut=84 wander=80 want=5 want_=-72 want_a=62 want_is=-85
    want_the=-174 want_to=29 want_you=45 wanted=97 wanted_to=62 wanting=20 wants=200
    wants_you=200 ward=-17 wardrobe=-153 wardrobe_=-193 wardrobe_and=-116 warehouse=62 warm=21
    warmed=49 warmer=-51 warn=103 warning=199 warranty=165 was=200 was_=-70 was_a=140 was_in=106
    was_meant=147 was_on=106 was_the=200 was_thinking=147 was_written=200 wash=21
    wash_station=-70 washbasin=-29 washer=-200 washer_=-188 washer_and=-116 washing=-195
    washing_machine=-186 washing_machines=-78 washstand=-51 washtub=-51 wasn't=53 wasps=113
    wasteful=-29 wat=113 watch=-8 watches=-29 watching=80 watchtower=49 water=-132 water's=-51
    water_cooler=-200 water_fountain=-139 water_heater=-155 water_on=-99 water_tank=-70
    water_trough=-85 waterfall=-85 wave=-121 waved=113 waving=53 waxed=-29 way=24 way_=130
    way_across=-70 way_along=-110 way_and=113 way_around=-99 way_down=-195 way_into=-70
    way_is=117 way_of=-132 way_out=-121 way_over=-70 way_round=190 way_through=15 way_to=-99
    way_up=-110 way_you=78 waypoint=80 waypoints=-29 ways=-51 we=138 we'd=84 we'll=26 we're=78
    we're_going=-29 we're_not=62 we've=106 we've_got=12 we've_had=118 we_=53 we_are=200
    we_call=170 we_can=43 we_go=-21 we_had=109 we_have=121 weak=49 weapons=-3 wear=113
    wearing=118 weather=147 weather's=49 weave=-29 weaving=-29 web=113 wedding=75 wedge=-29
    wednesday=113 wee=-3 week=186 week's=132 week_=176 weekend=113 weekly=113 weeks=132
    weigh=113 weighbridge=-51 weighing=62 weight=-130 weight_bench=-70 weight_rack=-70
    weights=-99 welcome=50 welcome_to=53 welcoming=-29 well=50 well_=57 well_and=-3 well_i=-50
    wellies=-51 wen=-29 went=57 wept=49 were=200 were_mirrored=142 were_told=200 weren't=-29
    west=132 western=-29 westward=-29 wet=44 whale=-147 whale_skeleton=-99 what=200 what's=132
    what_=-3 what_a=183 what_i=119 what_is=156 what_it=157 what_the=200 what_they=113
    what_this=156 what_was=113 what_you=139 what_you're=62 whatever=200 whatever_is=200
    whatever_the=200 whatever_you=113 wheee=-29 wheel=32 wheel_=15 wheelbarrow=-85
    wheelchair=-99 wheelchairs=-98 wheelhouse=-51 wheels=168 wheels_=100 wheels_are=199 when=-35
    when_i=190 when_it=113 when_the=22 when_there's=-70 when_they=199 when_you=-130
    when_you're=-156 when_you've=-26 when_your=-3 whenever=188 whenever_you=200 where=50
    where_a=66 where_i=103 where_it=127 where_one=-36 where_people=-99 where_the=-73
    where_there's=-70 where_they=125 where_u=136 where_we're=-3 where_you=95 where_you'll=43
    where_your=-3 whereafter=-29 wherein=-29 whereupon=-110 whereupon_you=-70 wherever=200
    wherever_it=200 wherever_you=147 whether=147 which=-17 which_are=-85 which_has=-8 which_i=91
    which_is=-178 which_one=-130 which_point=-70 which_the=-121 which_there=-85 which_was=118
    which_you=10 whichever=-99 while=197 while_=116 whirl=113 whiskers=113 whisky=-29 whisper=49
    whispered=113 whistle=84 white=-200 white_door=-161 white_doors=-36 white_tiles=-110
    white_towels=-85 whiteboard=-200 whiteboard_=-161 whiteboard_turn=-70 whizz=-51 who=200
    who's=132 whoa=-51 whoever=200 whole=121 whole_time=62 whole_way=33 whom=103 whom_it=103
    whoopsie=-29 whopping=-29 whose=62 why=190 wicker=-200 wicker_bench=-78 wicker_chair=-85
    wide=-121 wider=-110 width=84 wife=49 wifi=113 wigs=-85 wild=113 will=-30 will_be=-58
    will_find=62 will_pass=-85 will_see=-200 willow=-51 win=80 winch=-51 wind=62 wind_chimes=-3
    winders=-29 winding=-51 window=-98 window's=-29 window_=-139 window_and=-71 window_at=-121
    window_in=-34 window_is=-17 window_on=-105 window_seat=-131 window_side=-121 window_so=-78
    window_that=-70 window_then=-85 window_turn=-126 window_with=-121 window_you=136
    windows=-144 windows_=-200 windows_and=-99 windows_on=-139 windows_to=-70 windowsill=-70
    wine=-165 wine_bar=-3 wine_barrel=-85 wine_bottles=-85 wine_cellar=-77 wine_fridge=-85
    wine_rack=-200 winery=-51 wing=135 wink=-51 winner=-51 winter=-51 wipe=165 wiped=113
    wire=-51 wires=113 wise=113 wish=199 wishes=113 wishing=-51 with=-67 with_a=-103
    with_all=-121 with_an=11 with_feet=-21 with_flowers=-85 with_four=43 with_full=116
    with_glass=-121 with_green=-99 with_immediate=199 with_it=114 with_its=62 with_lots=-110
    with_me=172 with_no=28 with_one=-3 with_regard=-70 with_round=-85 with_stars=-99
    with_the=-94 with_three=-110 with_tinsel=-85 with_two=-195 with_windows=-85 with_you=77
    with_your=-59 withdraw=-29 withdrawing=-29 withdrawn=200 withdrawn_this=81 within=31
    within_the=43 without=20 without_a=100 without_any=62 without_entering=-147
    without_going=-190 without_moving=116 without_stopping=62 witness=-51 wizard=113 wknd=49
    wlak=-110 wobbly=-121 wobbly_leg=-70 woke=113 wolf=113 woman=15 women=-29 won=156 won't=180
    won_the=200 wonder=-29 wonderful=20 wood=-48 wood_=80 wood_and=62 wood_floor=-70
    wood_stove=-99 wooden=-200 wooden_bench=-121 wooden_bridge=-70 wooden_deck=-70
    wooden_door=-200 wooden_floor=-168 wooden_gate=-99 wooden_one=-70 wooden_pews=-85
    wooden_stairs=-36 wooden_steps=-110 wooden_table=-110 woof=49 word=200 word_=199 words=200
    words_in=200 work=183 workbench=-168 workbench_=-121 worked=81 workers=113 working=62
    workshop=-36 world=176 worn=-70 worry=30 worth=132 would=85 would_ask=-70 would_be=45
    would_have=144 would_like=-21 would_you=-21 wouldn't=135 wow=12 wreath=-110 wreath_on=-70
    wrestler=-29 wristwatch=20 write=200 write_it=106 writer=199 writing=113 written=200
    written_=200 written_next=134 wrong=200 wrong_=43 wrong_way=200 wrongly=113 wrote=200
    wrote_this=199 wrought=-51 x=200 x_ray=-3 xc=113 xd=113 xff=113 xx=-51 xylophone=-51 yard=54
    yard_=28 yaw=62 ye=113 yea=-29 yeah=113 year=144 years=135 years_=103 yell=-29 yellow=-112
    yellow_blanket=-36 yellow_door=-50 yellow_line=-130 yellow_lines=-70 yellow_lockers=-85
    yellows=49 yep=-29 yes=-39 yes_i=-3 yes_left=-70 yesterday=186 yesterday's=132 yet=56
    yet_=30 yew=-29 yo=84 yoga=-110 yoga_mats=-85 yonder=-29 you=39 you'd=-73 you'd_be=-90
    you'd_go=-131 you'd_have=62 you'd_stop=-147 you'd_turn=-110 you'd_um=-70 you'd_you'd=-70
    you'll=-91 you'll_be=-60 you'll_come=-161 you'll_find=-61 you'll_go=-85 you'll_know=-110
    you'll_notice=-70 you'll_pass=-147 you'll_see=-200 you'll_spot=-70 you'll_stop=-70
    you'll_want=-161 you're=20 you're_a=200 you're_at=-131 you're_done=-147 you're_facing=-50
    you're_going=-146 you're_in=-56 you're_inside=-3 you're_looking=-147 you're_not=94
    you're_now=-70 you're_off=-3 you're_on=-85 you're_out=-99 you're_outside=-85
    you're_standing=10 you're_the=195 you're_there=-155 you're_to=-3 you've=112 you've_been=200
    you've_gone=1 you've_got=-30 you've_passed=-70 you_=61 you_a=191 you_and=-15 you_are=45
    you_arrive=-85 you_at=8 you_be=80 you_began=193 you_begin=54 you_bump=-99 you_came=40
    you_can=0 you_can't=107 you_come=-156 you_could=56 you_did=200 you_do=151 you_don't=85
    you_end=66 you_enter=-200 you_exit=-70 you_feel=176 you_find=-130 you_for=147 you_from=28
    you_get=-193 you_go=-166 you_have=116 you_hear=200 you_hit=28 you_hold=62 you_i=-21
    you_if=170 you_in=147 you_into=43 you_is=114 you_just=19 you_keep=80 you_know=130
    you_leave=62 you_like=185 you_look=66 you_lose=200 you_make=62 you_may=106 you_might=-62
    you_move=199 you_must=200 you_need=-2 you_no=170 you_not=-85 you_on=118 you_ought=136
    you_out=43 you_pass=-15 you_please=15 you_proceed=-139 you_push=-70 you_reach=-200
    you_read=200 you_remember=53 you_say=103 you_see=-27 you_shall=-8 you_should=-11 you_so=154
    you_stand=97 you_start=28 you_stay=62 you_stop=-184 you_take=-136 you_that=200 you_the=200
    you_then=-116 you_think=200 you_to=144 you_turn=-52 you_um=-99 you_undo=66 you_up=95
    you_wait=-110 you_walk=-72 you_want=-200 you_went=15 you_were=200 you_will=-190
    you_won't=103 you_would=34 you_you=-70 young=113 your=27 your_attention=-70 your_back=-194
    your_destination=-110 your_developer=161 your_eyes=186 your_feet=95 your_final=43
    your_first=170 your_head=129 your_job=136 your_journey=15 your_left=-179 your_memory=200
    your_mission=62 your_name=62 your_operator=172 your_orders=178 your_own=200 your_path=62
    your_place=95 your_position=28 your_present=199 your_right=-200 your_route=147
    your_second=-70 your_steps=44 your_stop=-70 your_stopping=-110 your_target=80 your_walk=199
    your_way=-48 your_wheels=200 youre=-70 yours=91 yourself=44 yourself_=170 yourself_and=28
    yourself_at=-85 yourself_in=-110 youth=49 youve=49 ystrday=49 yummy=-29 z=113 zeno=113
    zero=167 zero_=62 zone=-121 zoo=81 zxcv=113
    """
)
WORDS = {term: int(odds) / 100 for term, odds in (w.split("=") for w in _WORDS)}
