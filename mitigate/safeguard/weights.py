"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

OWN: dict[str, float] = {
    "bias": -3.303,
    "orders": 0.789,
    "text": 1.449,
    "annul": 0.855,
    "invert": 0.413,
    "case": 0.194,
    "halt": 1.111,
    "machine": 0.784,
    "role": 0.426,
    "authority": 1.417,
    "haste": 0.147,
    "if": 0.356,
    "me": -0.245,
    "you": 0.364,
    "third": 0.493,
    "past": 0.593,
    "not": 0.400,
    "here": 0.595,
    "time": 0.336,
    "go": 0.145,
    "has orders": 0.585,
    "has text": 0.802,
    "has annul": 0.886,
    "has invert": 0.655,
    "has case": 2.054,
    "has halt": -0.625,
    "has machine": 0.759,
    "has role": 0.515,
    "has authority": 1.384,
    "has haste": 0.179,
    "has if": -0.126,
    "has me": 0.372,
    "has you": -0.298,
    "has third": 0.390,
    "has past": 0.446,
    "has not": 0.529,
    "has here": -0.419,
    "has time": 0.388,
    "has go": 0.407,
    "hidden": 0.947,
    "alike": 0.457,
    "wide": 0.908,
    "spelled": 0.735,
    "leet": 0.890,
    "code": 0.589,
    "cipher": 0.490,
    "unknown": 1.766,
    "alien": 0.438,
    "foreign letters": 0.944,
    "late verb": 0.745,
    "no verb": 0.792,
    "on route": -0.245,
    "other things": -0.195,
    "nothing": 0.899,
    "turns": -0.241,
    "places": -1.074,
    "no place": 1.131,
    "length": -1.078,
    "short": -0.250,
    "commas": -1.259,
    "asks": -0.493,
    "exclaims": -0.208,
    "quoted": 1.555,
    "quote in": 0.745,
    "markup": 2.358,
    "role of": -0.000,
    "reported": 0.260,
    "self": 1.744,
    "about": 1.714,
    "back to text": 0.061,
    "elsewhere": 0.566,
    "annul orders": 0.183,
    "invert orders": 0.639,
    "case orders": 0.280,
    "not orders": -0.067,
    "halt nowhere": 0.150,
    "halt here": 0.648,
    "not go": -0.108,
    "both sides": 0.820,
    "case not": -0.658,
    "case go": 0.423,
    "case halt": 0.257,
    "me past": -0.327,
    "third past": -0.208,
    "you role": 0.439,
    "authority said": 0.183,
    "machine you": 0.302,
    "me no place": 0.476,
    "past no you": 0.095,
    "annul place": -0.126,
    "not place": 0.719,
    "if place": -0.205,
}
CONTEXT: dict[str, float] = {
    "bias": 0.172,
    "own": 0.881,
    "first": -0.670,
    "last": -0.057,
    "stops early": 1.785,
    "stops before all": 0.130,
    "denies the rest": 0.318,
    "repeats the rest": -0.270,
    "neighbour": 1.751,
    "neighbours": 0.786,
    "alone": -1.435,
    "most": -0.917,
}
PART: dict[str, float] = {
    "bias": -2.954,
    "whole": 0.041,
    "orders": 0.875,
    "text": 1.200,
    "annul": 0.843,
    "invert": 0.962,
    "case": 0.000,
    "halt": 1.482,
    "machine": 0.974,
    "role": 0.403,
    "authority": 1.897,
    "haste": 0.148,
    "if": 0.104,
    "me": -0.835,
    "you": 0.175,
    "third": 0.290,
    "past": 0.790,
    "not": 0.127,
    "here": 0.560,
    "time": 0.256,
    "go": -0.219,
    "has orders": 0.739,
    "has text": 1.242,
    "has annul": 0.843,
    "has invert": 0.962,
    "has case": 1.285,
    "has halt": -0.606,
    "has machine": 0.974,
    "has role": 0.403,
    "has authority": 1.897,
    "has haste": 0.148,
    "has if": 0.314,
    "has me": -0.646,
    "has you": 0.473,
    "has third": 0.401,
    "has past": 0.957,
    "has not": 0.401,
    "has here": -0.571,
    "has time": 0.373,
    "has go": -0.040,
    "hidden": 0.893,
    "alike": 0.000,
    "wide": 0.000,
    "spelled": 0.000,
    "leet": 1.488,
    "code": 0.873,
    "cipher": 0.503,
    "unknown": 1.385,
    "alien": -0.169,
    "foreign letters": -0.028,
    "late verb": 0.244,
    "no verb": -0.369,
    "on route": 0.029,
    "other things": -0.254,
    "nothing": 1.284,
    "turns": 0.252,
    "places": -1.323,
    "no place": 0.483,
    "length": -0.810,
    "short": -0.131,
    "commas": 1.312,
    "asks": -0.529,
    "exclaims": -1.311,
    "quoted": 1.610,
    "quote in": 1.712,
    "markup": 0.000,
    "role of": 0.191,
    "reported": 0.733,
    "self": 0.698,
    "about": 1.563,
    "back to text": 0.250,
    "elsewhere": 1.123,
    "annul orders": 1.081,
    "invert orders": 0.810,
    "case orders": 0.401,
    "not orders": 0.951,
    "halt nowhere": 0.046,
    "halt here": 0.353,
    "not go": 0.605,
    "both sides": 1.178,
    "case not": 0.108,
    "case go": 1.267,
    "case halt": 0.704,
    "me past": 0.393,
    "third past": 0.031,
    "you role": 0.341,
    "authority said": 0.170,
    "machine you": 0.398,
    "me no place": -0.320,
    "past no you": 0.132,
    "annul place": 0.401,
    "not place": 0.322,
    "if place": -0.309,
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
WORDS = bag(
    """
    10 12 120 135 14 15 16 18 180 20 204 214 270 30 306 308 310 408 45 7741 90 abandon
    abbreviations abeam able abort about above absolute absolutely abutment accents acceptable
    accident accommodation accomplished according accordingly accounting accounts ace
    acknowledge acquire across act action actual actually add added adjacent adjustment admin
    administrator administrator's admire admiring adorable adore advance adventure advised
    afford aft after again against agenda agent ago agree agreed ahead ahh ahhh ahoy aid aim air
    airlock aisle alarm alcove alighting align alive all alley allowed almost alone along alongs
    alongside alpha already alright alrighty also altar alter alters although always am amazing
    amble an anchor and angel angle annotator announces annulled another anticlockwise any
    anyhow anyone anything anytime anyway anywhere anywho apart apartment aperture appearance
    apples applies apply appreciate approach approved approximately aquarium arbitrary arcade
    arch arched arches archive archway are area aren't arguments arm arm's armchair armchairs
    armor armour armrest arms around arr arrival arrived arrow art artwork as ascend ascended
    ascending aside ask asked asks asleep assistant assumed at atm atrium attempt attention
    attic aunt aunt's auntie auntie's authorise authorised authority automatic available avoid
    avoided aw await away awesome awful awning axis axle azimuth babe babies baby baby's back
    back's backpack backpacks backs backwards bad baddies bag baggage bakery balanced balcony
    bales ball balloon ballroom balls balusters balustrade bamboo banana bananas bandage bang
    banister bank banquet baptismal baptistery bar barbecue barn barometer barracks barrel
    barrels barrier bars barstool base basement basket basketball baskets bath bathrobes
    bathroom bathtub battery bay be bead beaded beam bean beanbag beanbags beans bear bearing
    beautiful beauty because bed bedding bedroom bedrooms beds been beers before began begin
    beginner beginning begins begun behalf behind beige being believe believes bell bellhop's
    bells belly below belt bench benches bend bends beneath berth beside best bestie bet better
    between beyond bicycle bicycles bidet bifurcates big bigger biggest bike bikes billet
    billiard billiards bin bird birdbath birdcage birds birthday biscuit bisect bit bite black
    blackboard blanket blankie blast bleachers bless blew bliss block blood blotchy blue board
    boardroom boat bodies body boiler bollard bombing bones bong book bookcase bookcases books
    bookshelf bookshelves boom boot booth booths boots booze boring boss both bother bottles
    bottom bound boundary bounds bouquet bow bowl bowling box boxes boys braces brackets branch
    brand brass bravo breach bread break breakfast breaking breath breathe breather breathtaking
    breeze brick bricked bricks bridge bright bring brings brochure broke broken brolly bronze
    broom brother brother's brothers brown brr brrr brushes bubbles bubbling bucket buddha buddy
    buffer buffet bugs build building built bulb bulkhead bullet bulletin bullseye bum bump
    bunch bunk bunker bunks burgers burning bursting bushes business bust but butler's butterfly
    buttons buy by bypass cabin cabinet cabinets cabins cables cactus caf cafe cafeteria cage
    cake caked cakes call called calling calm calories came camera camp can can't cancel
    cancelled candle candles candy cannon cannons cannot canopy cans canteen capital capitals
    captain captain's car card cardies care careful carefully caretaker carousel carpet carpet's
    carpeted carpets carriage carried carries carrots carry carrying cars cart carts case cases
    cash casino cask castle castles casualty cat cat's catalog catalogue catch category cause
    cease ceiling cellar cello center central centre cereal chains chair chairs chalk chalkboard
    chambers champ chance chandelier chandelier's change changed changes changing chapel chapels
    characters charger charging charlie charm charming chart chassis chat chatting chatty check
    checked checkerboard checklist checkout checkpoint cheerful cheers cheery cheese chess chest
    chick chief child children children's chill chilly chimney china chinese chips chocolate
    choices choo choose chop chow christmas chuck chum church chute cinderella cinema circle
    circles circling circular circumference circumnavigate circumstances claims clang clank
    clarity class classroom clatter clattering claw clawed cleaner clear clearance cleared
    clerestory clerk's clever climb climbed climbing climbs cloakroom clock clockwise close
    closed closely closes closest closet closing cloth clothes clothing clue cmd coast coat
    coats coca cocoa code codes coffee coffees coin cola cold colon colonel colonnade colored
    colorful colors colour coloured column columns comb combined come comes comfort comfortably
    comfy coming command commander's commands comment commode companionway compass complaints
    complete completely completing completion compliance computer computers concentrate concern
    concerned concession concierge concierge's concrete condition conditional conference
    confessional confetti confirm confirmed confuse confuses confusing consecutive conservatory
    consider consideration console constant constraint cont'd contact contains content continue
    contradictory contrary control conveyor cooee cook cookies cooking cooks cool cooler
    coordinates copier copper copy corkscrew corner corporal correct correction corridor
    costumes cot cots cotton couch couches could couldn't count counted counter counting country
    counts couple course court courtyard cousin cousin's cover covered covers cowboy cozy cr
    crate crates crayons cream creative credenza crest crib cribs cried crikey crisps croissants
    cross crossed crosses crossing crossword crumbs crying crypt crystal crystals cubbies
    cubicle cubicles cuckoo cue cues cup cupboard cupboards cuppa cups curl curlers currency
    current currently curry curtain curtained curtains curtsy curve curved curves curving curvy
    cushion cushions custard cut cute cutest cutter cylinder cylinders da dad daddy daddy's daft
    daisy damage dance dancing danger dare dark darkroom darling dartboard dashes date datum
    dave davenport dawdle day daylight days de dead deadline dear decided decimetre decision
    deck decking declare deep deer defined definition degree degrees delete delivers delta demo
    demonstration den denial denials dentist's dentists dep depart department descend descending
    descends described description design desk desks destination detailed details detect
    detection detective determine developer developer's deviate deviation dexter di diagonally
    diametrically dictionary did different dig ding dingy dining dinosaur direction directional
    directions directly director dirty disabled discard disco dishwasher dismissed displacement
    display disregard disregarding distance ditto dive diving dizzy dj do dock doctor doctor's
    document documentation does doesn't dog dog's dogleg doing dokey doll dolls don't done dong
    donkey door door's doormat doors doorway doorways double doubling down downstairs downwards
    dr drafting drain draw drawbridge drawers drawing drawings drawn dreadful dream dreams
    dreamy drenched dresser dresses dressing dried drifting drill drink drinking drinks drip
    drive driver drives drop dropped drown drum drums dryer dryers drying duck ducts ductwork
    dum dumbbells dumpling dumpster dumpsters dungeon duty each earlier early earned earrings
    ears ease easel easiest east easy eat eaten eating echo echoey edge edges effect eggs egress
    egyptian eight eighth eighty either element elephant elevation elevator elevators eleven
    else em emergency emit empty end ends energy engine engineers engines enjoy enjoying enough
    ensuite enter entering entertainment entirety entrance entry entryway environment episode
    episodes equipment erase errand error escalator escalators espresso establishing ethics
    evacuation even event ever every everybody everyone everything everywhere ex exact exactly
    exam example except exception exchange exchanged exclude excluded excuse excuses execute
    executed executing execution exercise exit exit's exits expanded expanding expired explain
    explore exploring exposed extinguisher extract ey eye eyepiece eyes fab fabulous face
    facilities facing fact factor factory failed failure fake fall falling falls family fan
    fancy fantastic far farther farthest fast faster faucet fault favor favour feel feeling feet
    fell fella fella's fellow fence fern fetched fetches few ficus fiddling field fifteen fifth
    fig figures file filing fill filled fillers fills film fin final finally find fine finger
    fingers finish finished fire fireplace fires firewood first firstly fish fit fits fitting
    five fix fixtures flag flagpole flags flank flap flat flew flies flight flights flip float
    floor floorboard floors flop florist flower flowers flue fluffy fold folding follow followed
    following follows font food foosball foot footboard footstool for forbidden foreign forget
    forgetting forgot forgotten fork forks form forth forty forward forwards found fountain four
    fourteen fourth foxtrot foyer fragment frame framed free freedom freely freeze freezer
    french fresh freshen fresher fridge friend friend's friendly from front frosted froze frozen
    fruit fruits ft full fully fun function functional funnily funny furnace furniture further
    fuse fuss future fyi gabbing gallery galley game gangway gap garage garden gardening gas
    gate gave gawp gazebo gears geese gem general generator gentle gentlemen gently get gets
    getting giant gift giraffe give given gives giving glad glamorous glance glass glasses
    glazed glazing globe globes glove glowing glug go goal goals goat goes going gold golden
    gone good goodies goosebumps gorgeous gosh gossip got gowns grab gradient gramophone
    gramophone's gran's grand grandad's grandfather grandma's grandmother grandpa's granny
    granny's grass grate grateful grating graveyard gray great green greenhouse greeted grew
    grey grid grill ground grown guard guard's guardrail guardroom guess guest guests guitar
    gumball gun gunner's gym gymnasium ha had haha hair half halfway hall hall's hallway
    hallways hallyway halt halting hammock hammock's hamper hamster hand handedness handles
    handrail hands handy hang hangar hanging hangs hansen happy hard hardwood harp harpsichord
    has hash hat hatch hats have having hay hazard he he's head heading headmaster's
    headquarters headroom heads health hear heard heart hearth heated heater heave heavens heavy
    hedge heed heels height helical hello help helps hence henhouse her here here's hereby hero
    hey hi hidden hide hiding high higher highest hill him hint hippo his hit hiya hm hold
    holding holds hole holes home hon honestly honey hook hooks hoop hooray hoover hop hope
    hopeless horizontal horse horse's horses hose hospital hot hotel hour hours house houses
    hover how how's hug huge huh hum human humming hun hundred hung hungry hunt hurry husband
    hut hyphen i'd i'll i'm i've ice idea identical idle if ignore ignored ignoring ii iii ikea
    illuminated im image imagine immaterial immediate immediately important in inclination
    includes increased indefinitely indications indoor indoors infiltrate ingress initial inn
    inner innocent input inside insists inspector inspectors inst instance instead instruction
    instructions instrument intent interchanged interesting interior interlock intermediate
    internal interpret intersection intersects intervening interviews into invert inverted
    inviting iron ironing irrelevant is island isn't issue issued it it'll it's item items
    itinerary its itself iv jackets jacuzzi jeez jelly jigsaws job jog join journey judge
    judge's jug juice jukebox juliet jump jumper junction just karaoke karate kebab keep keeper
    keeping keeps kept kettle kevin key keyboard keypad keys kick kiddies kidding kids kill
    killing kiln kilo kind kindly kindness kinematics king king's kiosk kit kitchen kitchenette
    knee knees knife knight knitted knob knock knocker know knows la lab label labelled labels
    lad ladder ladies lady lady's lake lamp lamps landing landings landmark landmarks landscape
    lane lantern lap large largest laser last late later lateral lathe latin laugh laughing
    laundry lava law lawful lawn lawyers layman lead leading leads leaf leaning learn leather
    leave leaves leaving left leftmost leftovers lefts leftward leg legend lego legs leisurely
    lemon length lent less let let's letter letters level librarian library lid lie lies lieu
    life lifeboat lifeboats lifebuoy lifeguard lifeguard's lift lifts light lighted lighthouse
    lights like limb limit limits line line's lined linen lines link lintel lion lions list
    listen lit literally little lives living lizard load loading lobby lobby's lobster locate
    location locked locker lockers locomotion loft login long longer loo loo's look looking
    looks loom loose lose lost lot lots loud loudspeakers lounge lounger loungers love lovely
    loves lovey low lower lowest lt luck lucky luggage lunch lying machine machine's machines
    made magazine magazines magician magnificent magnitude mail mailbox mailboxes main maintain
    majesty make maker makes makeup making man management manager manager's mannequin mannequins
    mantelpiece manufacturer many map map's maps marble march mark marked market marks marquee
    married marshal marta masks massage massages massive master mat match mate mats matter may
    maybe maze me mean meaning means meant measured measuring meet meeting meetings memo memory
    mended mention mentioned mere mess message meta metal meteor meteorite meter meters method
    metre metres mezzanine microfilm microphone microwave middle midpoint might mike mikes mile
    milk miller's million mind mine mine's minerals mini minimise minimum ministry mint minus
    minute minutes mirror mirrored mirrors misc misreading miss misses missing mission mistake
    mister mistletoe mix mixed mode model moment money monitors mood mop mopping mops more
    morning mosey most mother mother's motion motionless motors mount mountains mounted mouse
    moustache move moved movement moves movie moving much mud mudroom mum mum's mummies mummy
    mummy's murder museum music must my myself nag nail namaste name named names nan nan's
    narrow natural naturally nave navigation nb nd near nearer nearest nearly neat need needed
    needn't needs negate negative negotiate neighbor neighbor's neighborhood neighbours neither
    nemo neon nephew nervous net never new newel news newspaper newspapers newsstand next nice
    nicer niche night nightmare nightstand nil nine ninety nip no nobody nomenclature nominal
    non none nonsense noodles nook nor normal north northbound nose not note notes nothing
    notice noticeboard noting november novice now nowhere nulling number numbers nurse nurse's
    nursery nurses o'clock obey object objective oblique observation observatory obsolete
    obstacle obstacles obvious obviously occupies occupy occurs ocean octagonal of off offer
    office officer official offset oh oi ok okay okey old older ollie on once one one's ones
    onload only onto ooh oops open opening opens opera operator operator's operators opposite
    optical optional options or orange orchids order ordered orders organ orientation origin
    oscar other others otherwise ottoman ought our ours out outdoor outer output outrank outside
    outvoted outward oval oven over override overshot overview overwatch overwrite owes own
    owner owner's paces page paint painted painting paintings pair pairs pajamas pal pale pallet
    pallets palm palms pane panel panic pantry pantry's pants papa paper papers par paragraph
    parallel parentheses parenthesis parish park parked parking parlor parlour part party pass
    passage passed passes passing past pat patch path patience patio patrol pattern pause pay
    pea peanuts pears peasy pebbles pedestal peek peel pegs penguin people percent perfect
    perform pergola permission permit perpendicular persian person pet petal pete pew pews pfff
    phase phew phone photo photographs photos phrase piano pianos pick picture pictures pie
    piece pieces pile pillar pillars pillows pinball pinch ping pink pins pipes pit pitch pivot
    place places plan plane planetarium planets planned plant planters plaque plaster plastic
    plate plates play player playhouse playing playroom please plinth plonk plotter plunge plus
    po's pocket podium point pointing points pointy poke pole poles police policy polish polite
    pommel pond pong ponies pool poor pop popcorn poppet porch port portable porthole portholes
    portrait portraits portside pose posh position post postcard postcards postcondition poster
    pot pots potted pottery potting pouffe poultry pouring powder power prams prayer precaution
    preconditions prep present presents press pressure pretend prettiest pretty previous
    principal's print printed printer printers prior priority privacy private privileges prize
    probably proceed projection projects pronto proof proud pssst pub pucker pull pulled pulpit
    pump punctuation pup's pupils puppet purple pursuant push pushing put puts putting pyjamas
    qty quarter quarters query question questions queue quick quickly quiet quietly quilt quilts
    quite quote quoted rack racks radiator radiators radio radiology rail railing railings rails
    railway rain rainbow raining rally ramp range rather ray rd reach reached reaching read
    readable reader reading reads ready real really rear rearward rearwards reason reasons
    recall recede received reception recessed recipe reciprocal recliner recliners recon record
    recovered recruit red reduce reduced redundantly reference reflective refrain refrigerator
    refuse refused regardless register reinstate reject rejected relaid relax relaying relief
    relieved relocation remain remainder remaining remains remark remember remind reminds remove
    repeat repeated replace replaced replacement report reported request requesting requests
    require required requirement requires rescinded research reserved resist respect rest
    restaurant restricted restroom restrooms result results resume retrace return reverse
    revoked revolution revolving rewarded rex rex's ride riding right right's righto rights
    rightwards righty rim ring rink riser risers rises riverside road robes robot robotics
    robots rock rocket rocking rocks roger role roll rolled roller rolling rolls roman romeo
    roof room room's rooms root rope rotate rotation rotations roughly round rounded rounding
    route routes row rowing rows rt rubber rubbish rug rule rules rumbling run runner running
    runs rush rxr sacristy saddle safe safest safety said sailor salad salon saloon same sandbox
    sandwich sanitary saturn sauna sausage saw say saying says scale scales scared scary
    scavenger school science sconces scoot scrap scratch scream screen screens script scroll
    scullery sculpture sea sealed search seashells seat seating seats sec second secondly secret
    secs section sectional sector secure security see seek seen sees segment select self sell
    sells semi send sendorfer sense sensor sent sentence sentences sentry separating separation
    sequence serious seriously server serves service serving set sets settle seven seventh
    sewing shade shall shaped sharp sharply she she'll she's shed sheep sheets shelf shells
    shelves shelving shhh shift shiny ship ship's shipping shoe shoes shooting shop shopping
    short shortcut shorter should shout shouted shove show shower showers shows shredder shush
    shut shutdown shutter shutters shutting shy side sideboard sides sierra sight sign signed
    signs sill silly silver simple simplest simplified since sing singing single sink sinks
    sister sister's sit sitrep sits sitting six sixth sixty size skeleton ski skinny skip
    skipped skirt skis skylight slashes sleep sleeping sleeps sleepy slept sliced slide slider
    slides sliding slight slightly slip slippery slippy slope sloping slot slow slowly small
    smalls smell smelling smells smelly smidge smile smooth snack snacks snail snake sneak
    snuggled so soak soap soccer socks sofa sofas soffit soft softie soldier some somebody
    someone someone's something sometimes somewhere son song soon sooner soonest sooo sore sorry
    sort sound sounds soup soup's source spa space spaces span spare sparkling speaker speakers
    speaking special species specifically speed spiders spin spinning spins spiral split splits
    spoken sports spot spring squad square squares squeaks squeeze squirts squishy st stable
    stack stacked staff stage stain stained stair staircase staircases stairs stairwell stall
    stalls stand standard standing stands star starboard stargazing staring stars start started
    starting starts state statements station stationary statue status stay stayed staying stays
    steady steam steel steeply steer steering step stepping steps steward stick sticks sticky
    still stinky stn stone stones stool stools stop stopped stopping stops store storeroom
    storey stove stow straight stranger streamers street stretcher stretching string stringed
    strings strip striped strips stripy stroll strollers stuck student students studio study
    stuff stuffed stuffy style subheading subj subject submarine success successive such
    suffices sugar suit suitcase suitcases summer sump sun sunburn sundays sundial sunflowers
    sunken sunny sunroom sunshine super superstar supervisor supplies supposed sure surface
    sushi suspended swan swap swapped sway swear sweep sweet sweetheart sweetie swimming swing
    swing's swinging swings swingy switch switched switches swivel swore sworn symbols sys
    system ta tabel table tables tada tail take taken takes taking talk tall taller tallest
    tango tank tap tape taped tapestry target task tasking tastes tasty taxi tea teacher
    teacher's teal team technician teddies teddy teenager's teenagers teeny teeth telephone
    telescope television tell teller telling tells telly tempting ten tenner tennis tent term
    terminal terminate terminates terminating terminus terms terrace terrible test text texts
    than thank thankful thanks that that's the theater theatre their theirs them theme
    themselves then there there'll there's thereafter thereof theres thermostat these they
    they'll they're they've thick thin thing things think thinking third third's thirdly thirsty
    this those though three threshold thrice throne through throughout throw throwing thru thumb
    thumping thx tick ticked ticket tickle ticks tiddles tie tied tiger tight tile tiled tiles
    till time times timetable timing tinsel tiny tiptoe tiptoes tired titchy title to tock today
    today's toddle todo toes together toilet toilets told tolerance tomatoes tomb tone tonight
    too took tool toolbox tools top topside toss totally touch tour tourist toward towards towel
    towels tower toy toys track tractor trade traffic train trainers trains trajectory
    trampoline transfer transition translate translation translation's trap trash travel travels
    traverse tray tread treadmill treadmills treads treasure treasure's treat tree treehouse
    trees trestle tricky trip trolley trolleys trophies trophy trot trotting trouble trough
    trucks true trun trunk trust try trying tub tucked tuesday tuesdays tulips tumble tummy
    tummy's tune tuner tunnel turn turned turning turns turnstile turnstiles tv twang tweet
    twelve twice twin twins twist twit two type typed typewriter typing typos uh um umbrella
    uncle under underneath understand understood undo undock unfinished unicorn uniform unit
    units universal unless unlike unlit unspecified until unusual up upholstery upon upper ups
    upside upstairs upstairses upward upwards urn us use used user user's using usually vacuum
    valid van vanity vase vases vault vector veer veering vegetables vehicle velocity velvet
    vending veranda verb verification verify version vertical very vessel's vestibule vestry
    vests via view vineyard vip vise visibility visible visit visually voice void voids volcano
    voted waffle waffles waist wait waiting wake wakes wakey wales walk walked walking walks
    walkway wall walled wallpaper walls wally walnut wander want wanted wants ward wardrobe warm
    warmer warn warning warranty was wash washer washing wasn't wasteful watch watches watching
    watchtower water wave waving waxed way waypoint waypoints ways we we'd we'll we're we've
    weak weapon wearing weather weave weaving wedding wedge wee week week's weighing weight
    weights welcome welcoming well wellies went wept were west western westward wet whale what
    what's whatever wheee wheel wheelbarrow wheelchair wheelchairs wheels when whenever where
    wherever whew which while whisky whisper whispered white whiteboard whizz who who's whoa
    whoever whole whoops whoopsie whopping whose why wicker wide wider width wigs will willow
    win winch wind winders window window's windows windowsill wine wing wings wink winner wins
    wipe wish wishing with withdrawn within without witness wlak wobbly woman women won't
    wonderful wood wooden woof woohoo word wording words work workbench working workshop worry
    would wouldn't wow wrapped wreath wristwatch write writes written wrong wrote xylophone
    yacht yard yaw yay yeah year years yell yellow yep yes yesterday yet yew yoga yoghurt yonder
    you you'd you'll you're you've your yours yourself yum yummy zero zone zoo
    """
)
